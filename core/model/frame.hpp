#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/image.hpp"
#include "core/model/types.hpp"

namespace planescope {

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
};

/// A point cloud as it came from a file: coordinates about `origin`, in file order.
struct PointSet {
  Vec3d origin = Vec3d::Zero();        // added to every point; keeps float exact far from 0
  std::vector<Vec3f> points;           // [m], NaN and (0,0,0) kept: the cloud stage drops them
  std::vector<std::uint8_t> rgb;       // 3 per point, or empty
  std::vector<std::uint8_t> label;     // 0 unknown, 1 h, 2 v per point, or empty
  std::vector<std::int32_t> instance;  // plane id per point, 0 none, or empty
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

}  // namespace planescope
