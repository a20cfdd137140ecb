#pragma once

// Labels carried from one frame to the next: motion by RGB-D odometry or ICP, then each plane is
// fitted to the new frame's own points. Where the camera's poses are known, labels of one frame are
// proposed in all that see its planes.

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// A carried plane of less confidence is in doubt.
inline constexpr double kSure = 0.8;

struct CarriedPlane {
  int id = 0;             // in the new frame: another one where its own is taken there
  double confidence = 0;  // share of the pixels it was expected on that lie on its fitted plane
  std::size_t pixels = 0, doubtful = 0;
};

struct CarriedLabels {
  FrameLabels labels;                 // of the new frame; confidence per plane, origin carried
  std::vector<std::uint8_t> doubt;    // per pixel: 1 a label was expected, and left to the user
  std::vector<CarriedPlane> planes;   // by id
  Pose T_to_from = Pose::Identity();  // sensor frames
  std::string method;                 // "RGB-D odometry", "ICP", "poses"
  double fitness = 0;                 // share of points with a partner after registration
  double rms_m = 0;                   // of partners
};

struct CarryOptions {
  std::optional<Pose> T_to_from;  // where it is known; else the frames are registered
  double min_fitness = 0.3;
  double min_confidence = 0.3;  // a plane below it is left out, all its pixels doubtful
};

/// Of depth images. `existing`: the new frame's labels, kept where they are; what is carried fills
/// the rest. Planes grow over what the first frame did not see, but not over borders that were
/// drawn in it; small holes are filled and specks dropped. Throws Error where the frames do not
/// overlap, Cancelled when stopped. Repeats bit by bit.
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
  /// What the partners say of a turn about the axes of `to` and a shift along them, rotation first,
  /// as if each were independent of the others.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double partners = 0;
};

/// Point-to-plane from coarse to fine, each point against what is seen where it falls in the other
/// image; where both frames have aligned colour, brightness counts as well. Starts from
/// `T_to_from`. Throws Cancelled when stopped. Sums run in one order: the same bits on every run.
Registration register_frames(const LabelGrid& from,
                             const LabelGrid& to,
                             std::stop_token stop,
                             const std::function<void(double)>& progress,
                             const Pose& T_to_from = Pose::Identity());

/// A frame as it is before labels are proposed in it.
struct SpreadFrame {
  Frame frame;
  LabelGrid grid;
  FrameLabels labels;
};

struct SpreadJob {
  int from = 0;    // whose labels are proposed
  int frames = 0;  // of the recording
  /// Throws Error where the frame cannot be labelled: it is left out.
  std::function<SpreadFrame(int frame)> open;
  /// Nothing: no pose is known, the frame is left out.
  std::function<std::optional<Pose>(int frame)> T_world_camera;
  std::stop_token stop = {};
  std::function<void(int done, int all)> progress = {};
};

/// What is proposed in a frame.
struct Proposal {
  LabelEdit edit;            // of the frame's labels as they were
  FrameLabels blank;         // of the frame, without images: what it is
  std::size_t doubtful = 0;  // pixels that are left open
};

Proposal proposal_of(LabelEdit edit, const FrameLabels& before);

/// Goes on from the labelled frame to both ends, each frame from the one before it and, for planes
/// that were out of sight there, from the labelled frame: cut to the frame's own depth, around
/// labels that are there. Frames in which nothing is proposed are left out. By frame. Throws Error
/// where `from` has no pose or no planes, Cancelled when stopped.
std::vector<Proposal> spread_labels(const SpreadJob& job);

}  // namespace planescope::labels
