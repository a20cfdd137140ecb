// The view that the pictures of one frame share.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/scenes.hpp"

namespace planescope {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFill = 0.90;       // share of the picture that the points may take
constexpr double kOutliers = 0.005;  // share of points that may stick out on each side

/// The value that all but `kOutliers` of `values` stay below.
double robust_max(std::vector<double>& values) {
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto k = n - 1 - static_cast<std::ptrdiff_t>(kOutliers * static_cast<double>(n));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// One axis of a frustum around points given as (offset across, depth along the view): the eye as
/// (across, along) such that |across - eye| <= slope (along - eye) just holds on both sides.
struct AxisFit {
  double across = 0;
  double along = 0;
};
AxisFit fit_axis(std::span<const double> across, std::span<const double> along, double slope) {
  std::vector<double> left(across.size()), right(across.size());
  for (std::size_t i = 0; i < across.size(); ++i) {
    right[i] = across[i] - slope * along[i];
    left[i] = -across[i] - slope * along[i];
  }
  const double a = robust_max(right), b = robust_max(left);
  return {(a - b) / 2, -(a + b) / (2 * slope)};
}

struct View {
  double elevation_deg = 0;  // of the eye above the horizon, seen from the target
  double yaw_deg = 0;        // of the eye to the right of the sensor's back
};
View view_of(const FrameResult& result) {
  // Only depth cameras look along their z axis; a cloud's pose turns gravity to -z, nothing more.
  const Vec3d forward = result.cloud.T_world_sensor.linear() * Vec3d::UnitZ();
  const bool depth_camera = forward.x() > 0.05;
  if (!depth_camera) return {35, 35};
  // A little above the sensor's own line of sight: far from it, its shadows open.
  const double pitch_deg = std::asin(std::clamp(-forward.z(), -1.0, 1.0)) / kDegree;
  return {std::clamp(pitch_deg + 10, 24.0, 55.0), 18};
}

}  // namespace

Camera frame_camera(const FrameResult& result, double aspect) {
  Camera camera;
  const View view = view_of(result);
  const double elevation = view.elevation_deg * kDegree, yaw = view.yaw_deg * kDegree;
  const Vec3d forward(std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
                      -std::sin(elevation));
  const Vec3d right = forward.cross(Vec3d::UnitZ()).normalized();
  const Vec3d up = right.cross(forward);

  std::vector<double> x, y, z;
  for (const Vec3f& point : result.voxels.points) {
    const Vec3d p = point.cast<double>();
    x.push_back(p.dot(right));
    y.push_back(p.dot(up));
    z.push_back(p.dot(forward));
  }
  if (x.empty()) {
    camera.eye = -2 * forward;
    return camera;
  }
  const double slope_y = kFill * std::tan(camera.fov_y_deg * kDegree / 2);
  const AxisFit fit_x = fit_axis(x, z, slope_y * aspect);
  const AxisFit fit_y = fit_axis(y, z, slope_y);
  std::nth_element(z.begin(), z.begin() + z.size() / 2, z.end());
  const double middle = z[z.size() / 2];
  const double along = std::min({fit_x.along, fit_y.along, middle - 0.2});

  camera.eye = fit_x.across * right + fit_y.across * up + along * forward;
  camera.target = camera.eye + (middle - along) * forward;
  camera.near_m = std::max(0.01, 0.02 * (middle - along));
  camera.far_m = std::max(200.0, 20 * (middle - along));
  return camera;
}

}  // namespace planescope
