// The view that the pictures of one frame share, and the one in which the window opens it.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/framing.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kOutliers = 0.005;  // share of points that may stick out on each side

/// The value that all but `kOutliers` of `values` stay below.
double robust_max(std::vector<double>& values) {
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto k = n - 1 - static_cast<std::ptrdiff_t>(kOutliers * static_cast<double>(n));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// One axis of a frustum around points given as (offset across, depth along the view). For an eye
/// at (across, along), every point has -low (depth - along) <= offset - across <= high (...).
struct AxisFit {
  double largest = 0;   // of offset - high * depth
  double smallest = 0;  // of offset + low * depth
  double low = 0, high = 0;

  /// The last place along the view from which all points are in.
  double along() const { return (smallest - largest) / (low + high); }
  /// From there or from farther back: across, so that as much room is left on both sides.
  double across(double along) const {
    return ((largest + high * along) + (smallest - low * along)) / 2;
  }
};
AxisFit fit_axis(std::span<const double> offset,
                 std::span<const double> depth,
                 double low,
                 double high) {
  std::vector<double> above(offset.size()), below(offset.size());
  for (std::size_t i = 0; i < offset.size(); ++i) {
    above[i] = offset[i] - high * depth[i];
    below[i] = -offset[i] - low * depth[i];
  }
  return {robust_max(above), -robust_max(below), low, high};
}

struct Placed {
  double elevation_deg = 0;  // of the eye above the horizon, seen from the target
  double yaw_deg = 0;        // of the line of sight, from world x towards y
};

Vec3d direction_of(const Placed& view) {
  const double elevation = view.elevation_deg * kDegree, yaw = view.yaw_deg * kDegree;
  return {std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
          -std::sin(elevation)};
}

/// How much of the planes' surface faces a viewer.
double facing(const planes::Segmentation& segmentation, const Vec3d& forward) {
  double sum = 0;
  for (const planes::PlaneRegion& plane : segmentation.planes)
    sum += plane.points * std::abs(plane.fit.normal.dot(forward));
  return sum;
}

/// From where the points were seen: the mean direction to them, as far as all lie to one side.
Vec3d sight_of(const planes::PreparedFrame& prepared) {
  const Vec3f sensor = prepared.sensor().cast<float>();
  Vec3d sum = Vec3d::Zero();
  for (const Vec3f& point : prepared.voxels.points)
    sum += (point - sensor).normalized().cast<double>();
  return sum / std::max<double>(1, static_cast<double>(prepared.voxels.points.size()));
}

Placed view_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation) {
  // Only depth cameras look along their z axis; a cloud's pose turns gravity to -z, nothing more.
  const Vec3d forward = prepared.cloud.T_world_sensor.linear() * Vec3d::UnitZ();
  const bool depth_camera = forward.x() > 0.05 || forward.z() < -0.9;
  Placed left{35, 35}, right{35, -35};
  if (depth_camera) {
    // A little above the sensor's own line of sight: far from it, the sensor's shadows open.
    const double pitch_deg = std::asin(std::clamp(-forward.z(), -1.0, 1.0)) / kDegree;
    left = {std::clamp(pitch_deg + 10, 24.0, 60.0), 18};
    right = {left.elevation_deg, -left.yaw_deg};
  } else if (const Vec3d sight = sight_of(prepared); sight.norm() > 0.7) {
    // A scan from one place, as it seems: from that side, or it is seen from behind.
    const double pitch_deg = std::asin(std::clamp(-sight.normalized().z(), -1.0, 1.0)) / kDegree;
    const double yaw_deg = std::atan2(sight.y(), sight.x()) / kDegree;
    left = {std::clamp(pitch_deg + 10, -60.0, 60.0), yaw_deg + 18};
    right = {left.elevation_deg, yaw_deg - 18};
  }
  // To the side from which more is seen; and, as the zero of a cloud often lies on the ground,
  // never from so low that what lies level is an edge.
  const bool from_right =
      facing(segmentation, direction_of(right)) > facing(segmentation, direction_of(left));
  Placed placed = from_right ? right : left;
  placed.elevation_deg = std::max(placed.elevation_deg, 24.0);
  return placed;
}

}  // namespace

Camera frame_camera(const planes::PreparedFrame& prepared,
                    const planes::Segmentation& segmentation,
                    double aspect) {
  Camera camera;
  const Vec3d forward = direction_of(view_of(prepared, segmentation));
  const Vec3d right = forward.cross(Vec3d::UnitZ()).normalized();
  const Vec3d up = right.cross(forward);

  std::vector<double> x, y, z;
  for (const Vec3f& point : prepared.voxels.points) {
    const Vec3d p = point.cast<double>();
    x.push_back(p.dot(right));
    y.push_back(p.dot(up));
    z.push_back(p.dot(forward));
  }
  if (x.empty()) {
    camera.eye = -2 * forward;
    return camera;
  }
  // The title stands above, the legend at the left.
  constexpr double kLeft = 0.80, kRight = 0.93, kTop = 0.84, kBottom = 0.92;
  const double slope = std::tan(camera.fov_y_deg * kDegree / 2);
  const AxisFit fit_x = fit_axis(x, z, kLeft * slope * aspect, kRight * slope * aspect);
  const AxisFit fit_y = fit_axis(y, z, kBottom * slope, kTop * slope);
  std::nth_element(z.begin(), z.begin() + z.size() / 2, z.end());
  const double middle = z[z.size() / 2];
  const double along = std::min({fit_x.along(), fit_y.along(), middle - 0.2});

  camera.eye = fit_x.across(along) * right + fit_y.across(along) * up + along * forward;
  camera.target = camera.eye + (middle - along) * forward;
  camera.near_m = std::max(0.01, 0.02 * (middle - along));
  camera.far_m = std::max(200.0, 20 * (middle - along));
  return camera;
}

Home home_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation) {
  const std::vector<Vec3f> all = reach_of(prepared.voxels.points, kOutliers);
  float size_m = 0;
  for (const Vec3f& a : all) size_m = std::max(size_m, (a - all[0]).norm());
  constexpr double kCells = 40;  // what is apart by more than one or two of them stands apart
  const double cell_m = std::max({size_m / kCells, 2 * prepared.voxels.size_m, 0.01});
  return {direction_of(view_of(prepared, segmentation)),
          reach_of(bulk_of(prepared.voxels.points, cell_m), kOutliers)};
}

}  // namespace planescope::render
