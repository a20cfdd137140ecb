#pragma once

// Stability of methods: the number of planes kept after an irrelevant change, and in the next
// frame. Counted by pixel.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/lab/rivals/rivals.hpp"
#include "core/model/frame.hpp"
#include "core/model/json_fields.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::lab {

// ---- Planes of two images ----

/// A plane's partner is the plane of the other image with the greatest IoU, if above this.
inline constexpr double kSteadyPartnerIou = 0.5;
/// Minimum IoU of planes that count as the same.
inline constexpr double kSamePlaneIou = 0.99;
/// A plane with at least this many compared pixels is big.
inline constexpr std::uint64_t kBigPlanePixels = 3000;
/// Two frames see the same surface if their depths differ by less than this share.
inline constexpr double kDepthAgreement = 0.03;

/// Planes of the first image found again in the second.
struct KeptPlanes {
  int planes = 0;      // of the first image, with at least one compared pixel
  int partners = 0;    // of those, with a partner
  double iou_sum = 0;  // over planes with a partner
  int big = 0, big_lost = 0;
};
void visit_fields(auto& fields, Same<KeptPlanes> auto& kept) {
  fields("planes", kept.planes);
  fields("partners", kept.partners);
  fields("iou_sum", kept.iou_sum);
  fields("big", kept.big);
  fields("big_lost", kept.big_lost);
}

struct Agreement {
  KeptPlanes all;
  KeptPlanes decided;        // the same, only for the first image's decided planes
  int second_planes = 0;     // of the second image, with at least one compared pixel
  int changed = 0;           // planes of the first image with no plane of IoU >= kSamePlaneIou
  std::vector<int> partner;  // by id - 1 of the first image; 0: none
};

/// `first`, `second`: plane ids by pixel, 0 none; pixels with -1 in `first` are not compared.
/// `undecided`: by id - 1 of the first image; ids beyond its end are decided.
Agreement compare_planes_by_pixel(std::span<const std::int32_t> first,
                                  std::span<const std::int32_t> second,
                                  std::span<const std::uint8_t> undecided = {});

/// A depth image in meters.
struct DepthMeters {
  Intrinsics intrinsics;
  std::vector<double> depth_m;  // by pixel v * width + u; 0: not measured, or out of range
};
DepthMeters depth_meters(const Frame& frame, double max_range_m);

/// The first image's plane ids at the pixels where the second image sees the same surface; -1 at
/// all others. Ignores lens distortion. `T_second_first`: between the cameras.
std::vector<std::int32_t> warp_planes(std::span<const std::int32_t> first_planes,
                                      const DepthMeters& first,
                                      const DepthMeters& second,
                                      const Pose& T_second_first);

/// The same without poses: pixel by pixel. Both images have the same size.
std::vector<std::int32_t> planes_in_place(std::span<const std::int32_t> first_planes,
                                          const DepthMeters& first,
                                          const DepthMeters& second);

// ---- Measurements ----

enum class SteadyPart : std::uint8_t { gravity, focal, rounded, dither, next };
/// Values of --only, in the order of the table.
constexpr std::array<const char*, 5> names_of(SteadyPart) {
  return {"gravity", "focal", "rounded", "dither", "next"};
}

/// A frame compared with itself after a change, or with the next frame.
struct SteadyPair {
  Agreement planes;
  int count_difference = 0;  // absolute difference of the numbers of planes
  // Partners of different class (h and v): their number, and the sum of the angles between their
  // normals (in the first image) and the limit between h and v [deg].
  int label_changes = 0;
  double label_changes_deg = 0;
  int report_errors = 0;  // reported by `report --baseline` with its built-in rules
};
void visit_fields(auto& fields, Same<SteadyPair> auto& pair) {
  fields("all", pair.planes.all);
  fields("decided", pair.planes.decided);
  fields("second_planes", pair.planes.second_planes);
  fields("changed", pair.planes.changed);
  fields("count_difference", pair.count_difference);
  fields("label_changes", pair.label_changes);
  fields("label_changes_deg", pair.label_changes_deg);
  fields("report_errors", pair.report_errors);
}

/// A method with one change, by frame: the pairs of a frame are its draws.
struct SteadyRow {
  SteadyPart part = SteadyPart::gravity;
  std::string change;  // "fx x (1 + 1e-7)"
  std::string method;
  struct OfFrame {
    int frame = 0;
    std::vector<SteadyPair> pairs;  // not empty
  };
  std::vector<OfFrame> frames;
};

/// Results for a recording.
struct SteadyScores {
  std::vector<SteadyRow> rows;       // by change, then by method
  std::vector<std::string> refused;  // one line for each skipped frame and method
};

/// By frame of the recording; empty if it has no poses at all.
using FramePoses = std::vector<std::optional<world::CameraPose>>;

/// The recording's own poses.
FramePoses own_poses(const io::Recording& recording);

/// A method with its options; `name` is for tables.
struct SteadyMethod {
  std::string name;
  planes::PipelineOptions options;
  const LibraryRival* rival = nullptr;
};

struct SteadyJob {
  const io::Recording* recording = nullptr;
  std::vector<int> frames;  // to measure; each with the recording's next one
  std::vector<SteadyMethod> methods;
  const planes::Classifier* classifier = nullptr;  // of our methods
  std::set<SteadyPart> parts;
  FramePoses poses;
  int turns = 20;   // of gravity, for each frame
  int threads = 1;  // for frames and methods
  std::function<void(int done, int all)> progress = {};
  std::stop_token stop = {};
};

/// Independent of the number of threads. Frames that a method refuses are skipped and listed.
/// Throws Error if the recording is not of depth images, a frame cannot be read, or all frames are
/// refused; Cancelled on stop.
SteadyScores measure_steady(const SteadyJob& job);

// The changes, for tests.

/// Rotates a unit vector by `angle_deg` about a perpendicular axis; `around_deg` selects that axis.
Vec3d turned(const Vec3d& direction, double angle_deg, double around_deg);
/// fx, fy, cx, cy to six significant digits.
Intrinsics rounded_to_six_digits(const Intrinsics& intrinsics);
/// Moves 5 % of the valid pixels one depth count up or down.
void dither(Image16& depth, std::uint64_t seed);

}  // namespace planescope::lab
