#pragma once

// A frame of a recording, and its ground truth labels.

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

/// Local surface inclination relative to gravity (Sec. III): h if the angle between the local
/// normal and gravity is at most 45 degrees, else v.
enum class Label : std::uint8_t { unknown = 0, h = 1, v = 2 };

constexpr std::array<const char*, 3> names_of(Label) { return {"unknown", "h", "v"}; }
/// `unknown`: text for a label that is neither h nor v.
inline const char* to_string(Label label, const char* unknown = "unknown") {
  return label == Label::h ? "h" : label == Label::v ? "v" : unknown;
}

/// Eq. (1) for the cosine of the angle between a normal of either sign and the up direction.
inline Label label_of_cosine(double cosine) {
  return std::abs(cosine) >= std::numbers::sqrt2 / 2 ? Label::h : Label::v;
}
/// For a unit normal in the world frame.
inline Label label_of_normal(const Vec3d& normal) { return label_of_cosine(normal.z()); }

enum class Distortion : std::uint8_t { none, brown_conrady, inverse_brown_conrady };
/// Names by value, as used in files.
constexpr std::array<const char*, 3> names_of(Distortion) {
  return {"none", "brown_conrady", "inverse_brown_conrady"};
}
inline const char* to_string(Distortion distortion) {
  return names_of(distortion)[static_cast<std::size_t>(distortion)];
}

/// Pinhole camera. The ray of pixel (u, v) is ((u-cx)/fx, (v-cy)/fy, 1): x right, y down, z
/// forward. `brown_conrady` (OpenCV): coefficients k1 k2 p1 p2 k3 map undistorted to
/// distorted coordinates.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]
  Distortion distortion = Distortion::none;
  std::array<double, 5> coefficients{};  // k1 k2 p1 p2 k3

  bool operator==(const Intrinsics&) const = default;
};

/// Source of a gravity direction; up to `assumed`, most reliable first. `none`: unknown, so no
/// points and planes are h or v. `carried`: from another frame of the recording, by the camera's
/// motion. Journals store the number: add new sources at the end.
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

/// Gravity as a unit vector in the sensor's (or cloud's) frame. If gravity is unknown, the
/// direction of the camera's lower edge, which still determines the world axes.
struct Gravity {
  Vec3d direction = Vec3d(0, 1, 0);
  GravitySource source = GravitySource::assumed;
  double confidence = 1;  // 0..1; below 1 only for estimates and gravity carried from them
  std::string note;       // a phrase for users: how it was determined

  bool known() const { return source != GravitySource::none; }
  bool operator==(const Gravity&) const = default;
};

/// A point cloud as read from a file: coordinates relative to `origin`, in file order.
struct PointSet {
  Vec3d origin = Vec3d::Zero();        // added to every point; keeps floats precise far from 0
  std::vector<Vec3f> points;           // [m], including NaN and (0,0,0), which the cloud
                                       // stage drops
  std::vector<std::uint8_t> rgb;       // 3 per point, or empty
  std::vector<std::uint8_t> label;     // 0 unknown, 1 h, 2 v per point, or empty
  std::vector<std::int32_t> instance;  // plane id per point, 0 none, or empty
  bool optical = false;                // axes of a camera: x right, y down, z forward
};

/// The origin, in whole meters, relative to which floats represent most points best: the center of
/// their bounds or, if the bounds are so large that floats no longer resolve hundredths of a
/// millimeter at the border, the median of each axis, which ignores outliers. Non-finite points are
/// ignored; zero if there are none.
Vec3d bulk_origin(std::span<const Vec3d> points);

/// Rounds depth in meters to counts and returns their unit [m]: `unit_m` or, without one, by the
/// rule in docs/formats.md ("Depth in meters"). `meters`: row by row, as many pixels as `counts`
/// has.
double round_meters(std::span<const float> meters, std::optional<double> unit_m, Image16& counts);

/// Previously found planes of a depth image.
struct GivenPlanes {
  Image16 plane_of;             // per pixel: id from 1, 0 none
  int listed = 0;               // number of listed planes; higher ids are minor planes
  std::vector<double> margins;  // by id - 1
};

/// One frame of a recording: either a depth image (with or without color) or a cloud.
struct Frame {
  int index = 0;           // 0-based index of the depth frame in the recording
  std::string name;        // name in the recording: file stem, sequence number
  double timestamp_s = 0;  // sensor's own clock; 0 if unknown

  Image16 depth;            // counts; 0: no measurement
  double depth_unit_m = 0;  // meters per count
  Intrinsics intrinsics;    // of the depth image

  Image8 color;                 // RGB; empty if none
  Intrinsics color_intrinsics;  // fx 0 if unknown: color can be shown, but not projected
  Pose T_color_depth = Pose::Identity();
  bool color_aligned = false;  // color is registered pixel by pixel to depth

  std::optional<PointSet> cloud;       // set for cloud recordings; then depth is empty
  std::optional<Gravity> gravity;      // from the recording (IMU, sidecar), sensor frame
  std::optional<Pose> T_world_camera;  // from the recording; world z is up

  /// Planes to use in place of finding them on pixels.
  std::shared_ptr<const GivenPlanes> given = {};

  bool is_cloud() const { return cloud.has_value(); }
};

inline constexpr std::uint16_t kPlaneIgnore = 65535;  // plane image: do not score this pixel
inline constexpr std::uint8_t kHvIgnore = 255;        // h/v image: do not score this pixel

/// Source of a plane's first labels.
enum class LabelOrigin : std::uint8_t { hand, wand, algorithm, carried, imported };
constexpr std::array<const char*, 5> names_of(LabelOrigin) {
  return {"hand", "wand", "algorithm", "carried", "imported"};
}

/// One labeled plane, in the sensor frame: normal . x = offset.
struct LabelPlane {
  int id = 0;  // 1..65534
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();
  double offset_m = 0;
  double rms_m = 0;
  double tolerance_m = 0;
  int fragments = 0;  // connected parts in the image
  LabelOrigin origin = LabelOrigin::hand;
  double confidence = 1;  // 0..1; below 1 only if carried from another frame and not yet edited
  bool locked = false;    // protected from all tools
  bool hidden = false;    // neither drawn nor selectable; kept and counted

  bool operator==(const LabelPlane&) const = default;
};

/// Ways in which labels and an algorithm, or two annotators, can disagree about a region.
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

/// A reviewer's decision about one region, identified by kind, position and size.
struct ReviewNote {
  DisagreementKind kind = DisagreementKind::missed;
  std::uint32_t pixel = 0;   // innermost pixel of the region: v * width + u
  std::uint32_t pixels = 0;  // size of the region
  int label_plane = 0, other_plane = 0;
  ReviewDecision decision = ReviewDecision::keep;
  std::string reviewer;
  std::int64_t time_s = 0;  // since 1970, UTC

  bool operator==(const ReviewNote&) const = default;
};

/// Ground truth of one depth frame, on its native pixels; or of one cloud, stored as one row of
/// pixels in file order.
struct FrameLabels {
  std::string depth_sha256;  // Recording::frame_hash of the labeled frame
  Intrinsics intrinsics;     // for clouds: the number of points as width, no focal length
  double depth_unit_m = 0;   // meters per count of that depth; 0: unknown, as in older files
  Gravity gravity;
  Vec3d origin = Vec3d::Zero();  // for clouds far from 0: origin of the plane coordinates
  Image16 plane;                 // plane id; 0 unlabeled, kPlaneIgnore
  Image8 hv;                     // 0 unknown, 1 h, 2 v, kHvIgnore
  std::vector<LabelPlane> planes;
  std::string annotator;
  std::string review_state;  // "unreviewed", "reviewed"
  std::vector<ReviewNote> review;

  bool is_cloud() const { return intrinsics.fx == 0 && intrinsics.height == 1; }
};

}  // namespace planescope
