#pragma once

// Carries labels from one frame to the next: finds the motion by RGB-D odometry or ICP, then fits
// each plane to the new frame's points. If the camera's poses are known, labels of one frame are
// proposed in all frames that see its planes.

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// Carried planes with less confidence are doubtful.
inline constexpr double kSure = 0.8;

struct CarriedPlane {
  int id = 0;             // in the new frame: a new one if its own is in use
  double confidence = 0;  // share of its expected pixels that are on its fitted plane
  std::size_t pixels = 0, doubtful = 0;
};

struct CarriedLabels {
  FrameLabels labels;                 // of the new frame; confidence per plane, origin carried
  std::vector<std::uint8_t> doubt;    // per pixel: 1 if a label was expected but left to the user
  std::vector<CarriedPlane> planes;   // by id
  Pose T_to_from = Pose::Identity();  // sensor frames
  std::string method;                 // "RGB-D odometry", "ICP", "poses"
  double fitness = 0;                 // share of points with a partner after registration
  double rms_m = 0;                   // of partners
};

struct CarryOptions {
  std::optional<Pose> T_to_from;  // if known; else the frames are registered
  double min_fitness = 0.3;
  double min_confidence = 0.3;  // planes below it are skipped, all their pixels doubtful
};

/// For depth images. `existing`: the new frame's labels, which are kept; carried labels fill the
/// rest. Planes grow over pixels that the first frame did not see, but not over borders drawn in
/// it; small holes are filled and specks dropped. Throws Error if the frames do not overlap,
/// Cancelled if stopped. Bitwise repeatable.
CarriedLabels carry_labels(const Frame& from_frame,
                           const LabelGrid& from,
                           const FrameLabels& labels,
                           const Frame& to_frame,
                           const LabelGrid& to,
                           const FrameLabels& existing,
                           const CarryOptions& options,
                           std::stop_token stop,
                           const std::function<void(double)>& progress = {});

// The motion between two depth frames (carry_motion.cpp).

struct Registration {
  Pose T_to_from = Pose::Identity();
  bool used_color = false;
  double fitness = 0;  // share of points with a partner
  double rms_m = 0;    // of partners, across the surface
  /// Information about a rotation about the axes of `to` and a translation along them, rotation
  /// first, from all partners as if they were independent.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double partners = 0;
};

/// Point-to-plane registration from coarse to fine. Each point is compared with the surface at its
/// projection in the other image; if both frames have aligned color, brightness counts as well.
/// Starts from `T_to_from`. Throws Cancelled if stopped. Sums have a fixed order, so the result is
/// bitwise repeatable.
Registration register_frames(const LabelGrid& from,
                             const LabelGrid& to,
                             std::stop_token stop,
                             const std::function<void(double)>& progress,
                             const Pose& T_to_from = Pose::Identity());

/// A frame before labels are proposed in it.
struct SpreadFrame {
  Frame frame;
  LabelGrid grid;
  FrameLabels labels;
};

struct SpreadJob {
  int from = 0;    // source of the labels
  int frames = 0;  // in the recording
  /// Throws Error if the frame cannot be labeled: it is skipped.
  std::function<SpreadFrame(int frame)> open;
  /// nullopt: pose unknown, the frame is skipped.
  std::function<std::optional<Pose>(int frame)> T_world_camera;
  std::stop_token stop = {};
  std::function<void(int done, int all)> progress = {};
};

/// Labels proposed in a frame.
struct Proposal {
  LabelEdit edit;            // relative to the frame's current labels
  FrameLabels blank;         // the frame's properties, without images
  std::size_t doubtful = 0;  // pixels left without a label
};

Proposal proposal_of(LabelEdit edit, const FrameLabels& before);

/// Proceeds from the labeled frame to both ends. Each frame gets labels from the previous one and,
/// for planes not visible there, from the labeled frame: cut to the frame's own depth, around
/// existing labels. Skips frames without proposals. Sorted by frame. Throws Error if `from` has no
/// pose or no planes, Cancelled if stopped.
std::vector<Proposal> spread_labels(const SpreadJob& job);

}  // namespace planescope::labels
