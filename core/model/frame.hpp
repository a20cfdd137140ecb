#pragma once

// A frame of a recording, and the ground truth that is drawn on one.

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope {

/// Local surface inclination against gravity (Sec. III): h where the angle between the local normal
/// and gravity is at most 45 degrees, v otherwise.
enum class Label : std::uint8_t { unknown = 0, h = 1, v = 2 };

constexpr std::array<const char*, 3> names_of(Label) { return {"unknown", "h", "v"}; }
/// `unknown`: the text for a label that is neither.
inline const char* to_string(Label label, const char* unknown = "unknown") {
  return label == Label::h ? "h" : label == Label::v ? "v" : unknown;
}

/// Eq. (1), of the cosine of the angle between a normal, on either side, and up.
inline Label label_of_cosine(double cosine) {
  return std::abs(cosine) >= std::numbers::sqrt2 / 2 ? Label::h : Label::v;
}
/// Of a unit normal, world frame.
inline Label label_of_normal(const Vec3d& normal) { return label_of_cosine(normal.z()); }

enum class Distortion : std::uint8_t { none, brown_conrady, inverse_brown_conrady };
/// Names by value, as files have them.
constexpr std::array<const char*, 3> names_of(Distortion) {
  return {"none", "brown_conrady", "inverse_brown_conrady"};
}
inline const char* to_string(Distortion distortion) {
  return names_of(distortion)[static_cast<std::size_t>(distortion)];
}

/// Pinhole camera. Pixel (u, v) looks along ((u-cx)/fx, (v-cy)/fy, 1): x right, y down, z forward.
/// `brown_conrady` (OpenCV): coefficients k1 k2 p1 p2 k3 take undistorted to distorted.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]
  Distortion distortion = Distortion::none;
  std::array<double, 5> coefficients{};  // k1 k2 p1 p2 k3

  bool operator==(const Intrinsics&) const = default;
};

/// Where a direction of gravity comes from; up to `assumed`, the most reliable first. `none`: it is
/// not known, and no point and no plane is h or v. `carried`: from another frame of the recording,
/// by the camera's motion. Journals store the number: add new sources at the end.
enum class GravitySource : std::uint8_t {
  option,
  sidecar,
  imu,
  picked,
  estimate,
  assumed,
  none,
  carried
};
inline constexpr GravitySource kLastGravitySource = GravitySource::carried;
constexpr std::array<const char*, 8> names_of(GravitySource) {
  return {"option", "sidecar", "imu", "picked", "estimate", "assumed", "none", "carried"};
}
inline const char* to_string(GravitySource source) {
  return names_of(source)[static_cast<std::size_t>(source)];
}

/// The direction in which things fall, a unit vector in the sensor's (or cloud's own) frame. Where
/// gravity is not known, the direction of the camera's lower edge: the world's axes follow it all
/// the same.
struct Gravity {
  Vec3d direction = Vec3d(0, 1, 0);
  GravitySource source = GravitySource::assumed;
  double confidence = 1;  // 0..1; below 1 only for estimates and what is carried from them
  std::string note;       // one phrase for people: how it was found

  bool known() const { return source != GravitySource::none; }
  bool operator==(const Gravity&) const = default;
};

/// A point cloud as it came from a file: coordinates about `origin`, in file order.
struct PointSet {
  Vec3d origin = Vec3d::Zero();        // added to every point; keeps float exact far from 0
  std::vector<Vec3f> points;           // [m], NaN and (0,0,0) kept: the cloud stage drops them
  std::vector<std::uint8_t> rgb;       // 3 per point, or empty
  std::vector<std::uint8_t> label;     // 0 unknown, 1 h, 2 v per point, or empty
  std::vector<std::int32_t> instance;  // plane id per point, 0 none, or empty
  bool optical = false;                // axes of a camera: x right, y down, z forward
};

/// About which floats tell the bulk of the points best, in whole metres: the middle of their bounds
/// or, where these are so large that a float at their border no longer resolves hundredths of a
/// millimetre, the median of each axis, which strays do not move. Points that are not finite do not
/// count; none: zero.
Vec3d bulk_origin(std::span<const Vec3d> points);

/// Planes of a depth image that were found before.
struct GivenPlanes {
  Image16 plane_of;             // per pixel: id from 1, 0 none
  int listed = 0;               // planes; further ids are of minor ones
  std::vector<double> margins;  // by id - 1
};

/// One frame of a recording: either a depth image (with or without colour) or a cloud.
struct Frame {
  int index = 0;           // 0-based number of the depth frame in the recording
  std::string name;        // as the recording calls it: file stem, sequence number
  double timestamp_s = 0;  // sensor's own clock; 0 where unknown

  Image16 depth;            // counts; 0 = no measurement
  double depth_unit_m = 0;  // metres per count
  Intrinsics intrinsics;    // of the depth image

  Image8 color;                 // RGB, empty where none
  Intrinsics color_intrinsics;  // fx 0 where unknown: colour can be shown, not projected
  Pose T_color_depth = Pose::Identity();
  bool color_aligned = false;  // colour is registered pixel by pixel to depth

  std::optional<PointSet> cloud;       // set for cloud recordings; then depth is empty
  std::optional<Gravity> gravity;      // from the recording itself (IMU, sidecar), sensor frame
  std::optional<Pose> T_world_camera;  // likewise; the world's z is up

  /// Where planes are found on pixels, these are taken in their place.
  std::shared_ptr<const GivenPlanes> given = {};

  bool is_cloud() const { return cloud.has_value(); }
};

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
