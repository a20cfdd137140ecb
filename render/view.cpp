// Camera projection, and placement of cameras so that their subject fills the view.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kOutliers = 0.005;  // share of points that may be outside on each side

// Rows: right, up and back in world coordinates. If `up` is along the view, any directions will do.
Mat3d eye_axes(const Camera& camera) {
  Vec3d back = camera.eye - camera.target;
  if (back.norm() < 1e-12) back = Vec3d::UnitZ();
  back.normalize();
  Vec3d right = camera.up.cross(back);
  if (right.norm() < 1e-9) right = back.unitOrthogonal();
  right.normalize();
  Mat3d axes;
  axes.row(0) = right;
  axes.row(1) = back.cross(right);
  axes.row(2) = back;
  return axes;
}

}  // namespace

View make_view(const Camera& camera, int width, int height, double screen_scale) {
  View view;
  view.screen_scale = screen_scale;
  view.width = width;
  view.height = height;
  view.orthographic = camera.orthographic;
  view.near_m = static_cast<float>(camera.near_m);
  view.far_m = static_cast<float>(camera.far_m);

  const Mat3d axes = eye_axes(camera);
  Eigen::Matrix4d to_eye = Eigen::Matrix4d::Identity();
  to_eye.topLeftCorner<3, 3>() = axes;
  to_eye.topRightCorner<3, 1>() = -axes * camera.eye;
  view.view = to_eye.cast<float>();

  const double n = camera.near_m;
  const double f = camera.far_m;
  const double aspect = static_cast<double>(width) / height;
  const double tan_half = std::tan(camera.fov_y_deg * 0.5 * M_PI / 180);
  Eigen::Matrix4d proj = Eigen::Matrix4d::Zero();
  if (camera.orthographic) {
    proj(0, 0) = 2 / (camera.ortho_height_m * aspect);
    proj(1, 1) = 2 / camera.ortho_height_m;
    proj(2, 2) = -2 / (f - n);
    proj(2, 3) = -(f + n) / (f - n);
    proj(3, 3) = 1;
    view.px_per_m = static_cast<float>(height / camera.ortho_height_m);
    view.px_per_m_at_target = height / camera.ortho_height_m;
  } else {
    proj(0, 0) = 1 / (tan_half * aspect);
    proj(1, 1) = 1 / tan_half;
    proj(2, 2) = -(f + n) / (f - n);
    proj(2, 3) = -2 * f * n / (f - n);
    proj(3, 2) = -1;
    const double px_per_m = height / (2 * tan_half);
    const double distance = (camera.eye - camera.target).norm();
    view.px_per_m = static_cast<float>(px_per_m);
    view.px_per_m_at_target = distance > 0 ? px_per_m / distance : 0;
  }
  view.proj = proj.cast<float>();
  return view;
}

std::optional<ScreenPoint> project(const View& view, const Vec3f& world) {
  const Eigen::Vector4f eye = view.view * world.homogeneous();
  const double depth_m = -eye.z();
  if (!(depth_m > view.near_m)) return std::nullopt;  // also if a coordinate is NaN
  const Eigen::Vector4f clip = view.proj * eye;
  ScreenPoint point;
  point.px.x() = (clip.x() / clip.w() * 0.5 + 0.5) * view.width;
  point.px.y() = (0.5 - clip.y() / clip.w() * 0.5) * view.height;
  point.depth_m = depth_m;
  return point;
}

// ---- Points that fill a view ----

namespace {

constexpr double kMargin = 0.92;  // share of the half view to fill on each side

/// Evenly distributed directions (Fibonacci lattice on the sphere).
Vec3d direction(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count;
  const double turn = std::numbers::pi * (1 + std::sqrt(5.0)) * i;
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// Smallest and largest coordinate of the points along `axis`.
struct Extent {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double length() const { return high - low; }
};
Extent span_along(std::span<const Vec3f> points, const Vec3d& axis) {
  const auto along = [&](const Vec3f& point) { return point.cast<double>().dot(axis); };
  const auto [low, high] = std::ranges::minmax_element(points, {}, along);
  return {along(*low), along(*high)};
}

/// The value that all but a share `outliers` of `values` stay below.
double robust_max(std::vector<double>& values, double outliers) {
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto k = n - 1 - static_cast<std::ptrdiff_t>(outliers * static_cast<double>(n));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[k];
}

/// One axis of a frustum around points given as (offset across, depth along the view). For an eye
/// at (across, along), every point satisfies -low (depth - along) <= offset - across <= high (...).
struct AxisFit {
  double largest = 0;   // maximum of offset - high * depth
  double smallest = 0;  // minimum of offset + low * depth
  double low = 0, high = 0;

  /// The closest position along the view from which all points are visible.
  double along() const { return (smallest - largest) / (low + high); }
  /// The position across the view, at or behind that position, that leaves equal margins.
  double across(double along) const {
    return ((largest + high * along) + (smallest - low * along)) / 2;
  }
};
AxisFit fit_axis(std::span<const Vec3f> points,
                 const Vec3d& axis,
                 const Vec3d& forward,
                 double low,
                 double high,
                 double outliers) {
  std::vector<double> above, below;
  for (const Vec3f& point : points) {
    const Vec3d p = point.cast<double>();
    const double offset = p.dot(axis), depth = p.dot(forward);
    above.push_back(offset - high * depth);
    below.push_back(-offset - low * depth);
  }
  return {robust_max(above, outliers), -robust_max(below, outliers), low, high};
}

}  // namespace

std::vector<Vec3f> extent_of(std::span<const Vec3f> points, double outliers) {
  constexpr int kDirections = 96;
  constexpr std::size_t kEnough = 8000;  // number of points to sample
  std::vector<Vec3f> some;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kEnough);
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  std::vector<Vec3f> extent;
  if (some.empty()) return extent;
  const auto left_out = static_cast<std::size_t>(outliers * static_cast<double>(some.size()));
  const auto last = static_cast<std::ptrdiff_t>(some.size() - 1 - left_out);
  for (int i = 0; i < kDirections; ++i) {
    const Vec3f along = direction(i, kDirections).cast<float>();
    std::nth_element(some.begin(), some.begin() + last, some.end(),
                     [&](const Vec3f& a, const Vec3f& b) { return a.dot(along) < b.dot(along); });
    extent.push_back(some[last]);
  }
  return extent;
}

std::vector<Vec3f> bulk_of(std::span<const Vec3f> points, double cell_m) {
  using Cell = std::array<int, 3>;
  constexpr double kFar = 1e9;  // cells
  std::map<Cell, std::uint32_t> cells;
  std::vector<std::uint32_t> cell_of;
  std::vector<std::size_t> points_in;
  for (const Vec3f& point : points) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::clamp(std::floor(point[axis] / cell_m), -kFar, kFar));
    const auto at = cells.emplace(cell, static_cast<std::uint32_t>(cells.size())).first->second;
    if (at == points_in.size()) points_in.push_back(0);
    ++points_in[at];
    cell_of.push_back(at);
  }
  DisjointSets pieces(cells.size());
  for (const auto& [cell, index] : cells)
    for (int step = 0; step < 27; ++step) {
      const Cell beside = {cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1,
                           cell[2] + step / 9 - 1};
      if (const auto other = cells.find(beside); other != cells.end())
        pieces.join(index, other->second);
    }
  std::vector<std::size_t> piece_size(cells.size(), 0);
  for (std::uint32_t i = 0; i < points_in.size(); ++i) piece_size[pieces.root(i)] += points_in[i];
  std::vector<Vec3f> bulk;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (50 * piece_size[pieces.root(cell_of[i])] >= points.size()) bulk.push_back(points[i]);
  return bulk;
}

Camera camera_fitting(std::span<const Vec3f> extent, const Lens& lens) {
  Camera camera;
  camera.fov_y_deg = lens.fov_y_deg;
  camera.up = lens.up;
  Vec3d right = lens.forward.cross(lens.up);
  right = right.norm() > 1e-9 ? Vec3d(right.normalized()) : Vec3d(lens.forward.unitOrthogonal());
  const Vec3d upwards = right.cross(lens.forward);
  const double slope = std::tan(lens.fov_y_deg * kDegree / 2);
  constexpr double kNearest_m = 0.05;
  double across = 0, height = 0, target = 0, distance = 2;
  if (!extent.empty()) {
    const Extent x = span_along(extent, right), y = span_along(extent, upwards);
    const Extent z = span_along(extent, lens.forward);
    target = z.middle();
    if (lens.orthographic) {
      across = x.middle();
      height = y.middle();
      distance = std::max(x.length() / lens.aspect, y.length()) / (2 * kMargin * slope);
    } else {
      const auto fit = [&](const Vec3d& axis, double fill) {
        return fit_axis(extent, axis, lens.forward, fill, fill, 0);
      };
      const AxisFit wide = fit(right, kMargin * slope * lens.aspect);
      const AxisFit high = fit(upwards, kMargin * slope);
      across = wide.across(wide.along());
      height = high.across(high.along());
      distance = target - std::min(wide.along(), high.along());
    }
    distance = std::max(kNearest_m, lens.room * distance);
  }
  camera.target = across * right + height * upwards + target * lens.forward;
  camera.eye = camera.target - distance * lens.forward;
  camera.near_m = std::max(0.005, 0.02 * distance);
  camera.far_m = std::max(200.0, 20 * distance);
  return camera;
}

// ---- Default view of a frame ----

namespace {

struct Placed {
  double elevation_deg = 0;  // elevation of the eye above the horizon, from the target
  double yaw_deg = 0;        // yaw of the line of sight, from world x toward y
};

Vec3d direction_of(const Placed& view) {
  const double elevation = view.elevation_deg * kDegree, yaw = view.yaw_deg * kDegree;
  return {std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
          -std::sin(elevation)};
}

/// Visible area of the planes from a direction.
double facing(const planes::Segmentation& segmentation, const Vec3d& forward) {
  double sum = 0;
  for (const planes::PlaneRegion& plane : segmentation.planes)
    sum += plane.points * std::abs(plane.fit.normal.dot(forward));
  return sum;
}

/// Viewing direction of the sensor: the mean direction to the points; its length is near 1 if all
/// are on one side.
Vec3d sensor_direction(const planes::PreparedFrame& prepared) {
  const Vec3f sensor = prepared.sensor().cast<float>();
  Vec3d sum = Vec3d::Zero();
  for (const Vec3f& point : prepared.voxels.points)
    sum += (point - sensor).normalized().cast<double>();
  return sum / std::max<double>(1, static_cast<double>(prepared.voxels.points.size()));
}

Placed view_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation) {
  // Only depth cameras look along their z axis; a cloud's pose only rotates gravity to -z.
  const Vec3d forward = prepared.cloud.T_world_sensor.linear() * Vec3d::UnitZ();
  const bool depth_camera = forward.x() > 0.05 || forward.z() < -0.9;
  Placed left{35, 35}, right{35, -35};
  if (depth_camera) {
    // Slightly above the sensor's line of sight: far from it, the sensor's shadows become visible.
    const double pitch_deg = std::asin(std::clamp(-forward.z(), -1.0, 1.0)) / kDegree;
    left = {std::clamp(pitch_deg + 10, 24.0, 60.0), 18};
    right = {left.elevation_deg, -left.yaw_deg};
  } else if (const Vec3d to_points = sensor_direction(prepared); to_points.norm() > 0.7) {
    // Apparently a scan from one position: view from that side, not from behind.
    const double pitch_deg =
        std::asin(std::clamp(-to_points.normalized().z(), -1.0, 1.0)) / kDegree;
    const double yaw_deg = std::atan2(to_points.y(), to_points.x()) / kDegree;
    left = {std::clamp(pitch_deg + 10, -60.0, 60.0), yaw_deg + 18};
    right = {left.elevation_deg, yaw_deg - 18};
  }
  // From the side that shows more surface and, because the origin of a cloud is often on the
  // ground, never so low that level surfaces appear as edges.
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

  const std::vector<Vec3f>& points = prepared.voxels.points;
  if (points.empty()) {
    camera.eye = -2 * forward;
    return camera;
  }
  // The title is at the top, the legend on the left.
  constexpr double kLeft = 0.80, kRight = 0.93, kTop = 0.84, kBottom = 0.92;
  const double slope = std::tan(camera.fov_y_deg * kDegree / 2);
  const AxisFit fit_x =
      fit_axis(points, right, forward, kLeft * slope * aspect, kRight * slope * aspect, kOutliers);
  const AxisFit fit_y = fit_axis(points, up, forward, kBottom * slope, kTop * slope, kOutliers);
  std::vector<double> depths;
  for (const Vec3f& point : points) depths.push_back(point.cast<double>().dot(forward));
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  const double middle = depths[depths.size() / 2];
  const double along = std::min({fit_x.along(), fit_y.along(), middle - 0.2});

  camera.eye = fit_x.across(along) * right + fit_y.across(along) * up + along * forward;
  camera.target = camera.eye + (middle - along) * forward;
  camera.near_m = std::max(0.01, 0.02 * (middle - along));
  camera.far_m = std::max(200.0, 20 * (middle - along));
  return camera;
}

Camera frame_camera(const planes::FrameResult& result, double aspect) {
  return frame_camera(result, result.segmentation, aspect);
}

Home home_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation) {
  const std::vector<Vec3f> all = extent_of(prepared.voxels.points, kOutliers);
  float size_m = 0;
  for (const Vec3f& a : all) size_m = std::max(size_m, (a - all[0]).norm());
  constexpr double kCells = 40;  // pieces more than one or two cells apart are separate
  const double cell_m = std::max({size_m / kCells, 2 * prepared.voxels.size_m, 0.01});
  return {direction_of(view_of(prepared, segmentation)),
          extent_of(bulk_of(prepared.voxels.points, cell_m), kOutliers)};
}

}  // namespace planescope::render
