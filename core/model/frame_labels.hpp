#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/image.hpp"
#include "core/model/label.hpp"

namespace planescope {

inline constexpr std::uint16_t kPlaneIgnore = 65535;  // plane image: do not score this pixel
inline constexpr std::uint8_t kHvIgnore = 255;        // h/v image: likewise

/// Who or what drew a plane first.
enum class LabelOrigin : std::uint8_t { hand, wand, algorithm, carried, imported };
constexpr std::array<const char*, 5> names_of(LabelOrigin) {
  return {"hand", "wand", "algorithm", "carried", "imported"};
}

/// One labelled plane, in the sensor's frame: normal . x = offset.
struct LabelPlane {
  int id = 0;  // 1..65534
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();
  double offset_m = 0;
  double rms_m = 0;
  double tolerance_m = 0;
  int fragments = 0;  // connected parts in the image
  LabelOrigin origin = LabelOrigin::hand;
  double confidence = 1;  // 0..1; below 1 only where carried from another frame and not yet touched
  bool locked = false;    // no tool changes its pixels
  bool hidden = false;    // not drawn, and nothing selects its pixels; kept and counted

  bool operator==(const LabelPlane&) const = default;
};

/// How labels and an algorithm, or two annotators, can disagree about a region.
enum class DisagreementKind : std::uint8_t {
  missed,
  invented,
  split,
  merged,
  class_flip,
  boundary
};
constexpr std::array<const char*, 6> names_of(DisagreementKind) {
  return {"missed", "invented", "split", "merged", "class_flip", "boundary"};
}
enum class ReviewDecision : std::uint8_t { keep, take, edit, ignore };
constexpr std::array<const char*, 4> names_of(ReviewDecision) {
  return {"keep", "take", "edit", "ignore"};
}

/// What a reviewer decided about one region; found again by its kind, place and size.
struct ReviewNote {
  DisagreementKind kind = DisagreementKind::missed;
  std::uint32_t pixel = 0;   // deepest inside the region: v * width + u
  std::uint32_t pixels = 0;  // of the region
  int label_plane = 0, other_plane = 0;
  ReviewDecision decision = ReviewDecision::keep;
  std::string reviewer;
  std::int64_t time_s = 0;  // since 1970, UTC

  bool operator==(const ReviewNote&) const = default;
};

/// Ground truth of one depth frame, on its native pixels; or of one cloud, whose points are one row
/// of pixels in file order.
struct FrameLabels {
  std::string depth_sha256;  // Recording::frame_hash of the frame that was labelled
  Intrinsics intrinsics;     // of a cloud: its points as the width, no focal length
  double depth_unit_m = 0;   // metres per count of that depth; 0: not known, as in older files
  Gravity gravity;
  Vec3d origin = Vec3d::Zero();  // of a cloud far from 0: what planes are about
  Image16 plane;                 // plane id; 0 unlabelled, kPlaneIgnore
  Image8 hv;                     // 0 unknown, 1 h, 2 v, kHvIgnore
  std::vector<LabelPlane> planes;
  std::string annotator;
  std::string review_state;  // "unreviewed", "reviewed"
  std::vector<ReviewNote> review;

  bool is_cloud() const { return intrinsics.fx == 0 && intrinsics.height == 1; }
};

}  // namespace planescope
