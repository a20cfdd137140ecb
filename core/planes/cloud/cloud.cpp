// Sun et al. 2023, Sec. II-A and V: back-projection, range crop and the octree's cube.

#include "core/planes/cloud/cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/model/error.hpp"
#include "core/planes/cloud/camera.hpp"
#include "core/planes/simd/pixel_kernels.hpp"

#pragma GCC diagnostic ignored "-Wunknown-pragmas"  // clang does not support ivdep

namespace planescope::planes {
namespace {

constexpr int kDeepestOctree = 21;  // three coordinates of 21 bits make a 64-bit key

void check(const CloudOptions& options) {
  if (!(options.max_range_m > 0))
    throw Error("max_range_m is " + std::to_string(options.max_range_m) +
                "; expected a number above 0");
  if (!(options.cube_edge_m > 0) || !std::isfinite(options.cube_edge_m))
    throw Error("cube_edge_m is " + std::to_string(options.cube_edge_m) +
                "; expected a finite number above 0");
  if (options.base_depth < 1 || options.base_depth > kDeepestOctree)
    throw Error("base_depth is " + std::to_string(options.base_depth) + "; expected 1 to 21");
}

/// The smallest cube_edge * 2^k that contains `extent_m`; at most the largest cube whose leaves
/// keep their size and whose voxel keys fit into 64 bits.
Cube make_cube(const Vec3d& center, double extent_m, const CloudOptions& options) {
  const double most_m = options.voxel_size_m * (1 << (kDeepestOctree - 1));
  Cube cube;
  cube.edge_m = options.cube_edge_m;
  cube.max_depth = options.base_depth;
  while (cube.edge_m < extent_m && cube.max_depth < kDeepestOctree &&
         (options.voxel_size_m == 0 || 2 * cube.edge_m < most_m)) {
    cube.edge_m *= 2;
    ++cube.max_depth;
  }
  cube.min_corner = center - Vec3d::Constant(cube.edge_m / 2);
  return cube;
}

/// Half-open, so every kept point has a cell.
bool inside(const Cube& cube, const Vec3f& point) {
  const Vec3d offset = point.cast<double>() - cube.min_corner;
  return offset.minCoeff() >= 0 && offset.maxCoeff() < cube.edge_m;
}

/// Marks the points to keep and counts all of them.
void crop(Cloud& cloud, const std::vector<std::uint8_t>& within_range) {
  cloud.kept.resize(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!within_range[i]) {
      ++cloud.counts.beyond_range;
    } else if (!inside(cloud.cube, cloud.points[i])) {
      ++cloud.counts.outside_cube;
    } else {
      cloud.kept[i] = 1;
      ++cloud.counts.kept;
    }
  }
}

/// Output position in a cloud with room for every pixel.
struct CloudEnd {
  float* point = nullptr;  // x, y, z
  std::uint32_t* source = nullptr;
  std::uint8_t* kept = nullptr;
};

/// `row` has been processed by the kernel; `pixel`: index of its first pixel.
CloudEnd append_points(const ProjectArgs& row, std::size_t pixel, CloudEnd to) {
  constexpr std::size_t kAtOnce = 16;
  const float *const x = row.x, *const y = row.y, *const z = row.z;
  const std::uint8_t* const fate = row.fate;
  const auto append_some = [&](std::size_t first, std::size_t last) {
    for (std::size_t u = first; u < last; ++u) {  // no branch: holes are unpredictable
      to.point[0] = x[u], to.point[1] = y[u], to.point[2] = z[u];
      *to.source = static_cast<std::uint32_t>(pixel + u);
      *to.kept = fate[u] == PixelFate::kept;
      const bool is_point = fate[u] >= PixelFate::beyond_range;
      to.point += 3 * is_point, to.source += is_point, to.kept += is_point;
    }
  };
  std::size_t u = 0;
  for (; u + kAtOnce <= row.count; u += kAtOnce) {
    int other = 0;
    for (std::size_t k = 0; k < kAtOnce; ++k) other |= fate[u + k] < PixelFate::beyond_range;
    if (other != 0) {
      append_some(u, u + kAtOnce);
      continue;
    }
#pragma GCC ivdep
    for (std::size_t k = 0; k < kAtOnce; ++k) {
      to.point[3 * k] = x[u + k];
      to.point[3 * k + 1] = y[u + k];
      to.point[3 * k + 2] = z[u + k];
    }
    for (std::size_t k = 0; k < kAtOnce; ++k)
      to.source[k] = static_cast<std::uint32_t>(pixel + u + k);
#pragma GCC ivdep
    for (std::size_t k = 0; k < kAtOnce; ++k) to.kept[k] = fate[u + k] == PixelFate::kept;
    to.point += 3 * kAtOnce, to.source += kAtOnce, to.kept += kAtOnce;
  }
  append_some(u, row.count);
  return to;
}

/// The smallest float not below `least_m`.
float float_from(double least_m) {
  const auto rounded = static_cast<float>(least_m);
  return rounded < least_m ? std::nextafter(rounded, std::numeric_limits<float>::max()) : rounded;
}

/// The smallest float at least `edge_m` beyond a corner.
float float_beyond(double corner_m, double edge_m) {
  constexpr float kMost = std::numeric_limits<float>::max();
  auto end = static_cast<float>(corner_m + edge_m);
  while (end - corner_m >= edge_m) end = std::nextafter(end, -kMost);
  while (end - corner_m < edge_m) end = std::nextafter(end, kMost);
  return end;
}

/// The largest depth count within range.
int counts_within(double max_range_m, double unit_m) {
  constexpr int kMost = std::numeric_limits<std::uint16_t>::max();
  int counts = static_cast<int>(std::min<double>(kMost, max_range_m / unit_m));
  while (counts > 0 && counts * unit_m > max_range_m) --counts;
  while (counts < kMost && (counts + 1) * unit_m <= max_range_m) ++counts;
  return counts;
}

/// Row by row: back-projects the pixels, rotates and crops them, and appends the points.
void add_pixels(const Frame& frame, double max_range_m, Cloud& cloud) {
  const auto width = static_cast<std::size_t>(cloud.width);
  std::vector<float> x(width), y(width), z(width);
  std::vector<std::uint8_t> fate(width);
  std::uint64_t fates[5] = {};
  ProjectArgs row{.count = width,
                  .unit_m = frame.depth_unit_m,
                  .most_counts = counts_within(max_range_m, frame.depth_unit_m),
                  .x = x.data(),
                  .y = y.data(),
                  .z = z.data(),
                  .fate = fate.data(),
                  .pixels_of_fate = fates};
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) row.turn[axis][k] = cloud.T_world_sensor.linear()(axis, k);
    row.from[axis] = float_from(cloud.cube.min_corner[axis]);
    row.to[axis] = float_beyond(cloud.cube.min_corner[axis], cloud.cube.edge_m);
  }
  const PixelKernels& kernels = pixel_kernels(best_simd());
  const std::shared_ptr<const RayTable> table = ray_table(frame.intrinsics);
  std::vector<double> scratch;
  cloud.points.resize(frame.depth.pixels());
  cloud.source.resize(frame.depth.pixels());
  cloud.kept.resize(frame.depth.pixels());
  CloudEnd end{reinterpret_cast<float*>(cloud.points.data()), cloud.source.data(),
               cloud.kept.data()};
  for (int v = 0; v < cloud.height; ++v) {
    const RayRow rays = table->row(v, scratch);
    row.depth = &frame.depth.at(0, v);
    row.ray_x = rays.x, row.ray_y = rays.y;
    kernels.project(row);
    end = append_points(row, v * width, end);
  }
  CloudCounts& counts = cloud.counts;
  counts.no_measurement = fates[PixelFate::no_measurement];
  counts.invalid = fates[PixelFate::no_ray];
  counts.beyond_range = fates[PixelFate::beyond_range];
  counts.outside_cube = fates[PixelFate::outside_cube];
  counts.kept = fates[PixelFate::kept];
  const auto points = static_cast<std::size_t>(end.source - cloud.source.data());
  cloud.points.resize(points);
  cloud.source.resize(points);
  cloud.kept.resize(points);
}

Cloud cloud_of_depth(const Frame& frame, const Gravity& gravity, const CloudOptions& options) {
  const Image16& depth = frame.depth;
  const Intrinsics& k = frame.intrinsics;
  check_camera(frame);
  Cloud cloud;
  cloud.T_world_sensor = world_from_gravity(gravity.direction, true);
  cloud.width = depth.width;
  cloud.height = depth.height;
  cloud.focal_px = std::sqrt(std::abs(k.fx * k.fy));
  // Depth images contain nothing beyond 65534 counts, however large the requested range.
  const double farthest_m = std::min(options.max_range_m, 65534 * frame.depth_unit_m);
  cloud.cube = make_cube(Vec3d::Zero(), 2 * farthest_m, options);
  cloud.counts.pixels = depth.pixels();
  add_pixels(frame, options.max_range_m, cloud);
  return cloud;
}

Cloud cloud_of_points(const Frame& frame, const Gravity& gravity, const CloudOptions& options) {
  const PointSet& set = *frame.cloud;
  Cloud cloud;
  cloud.T_world_sensor = world_from_gravity(gravity.direction, false);
  const Mat3d R = cloud.T_world_sensor.linear();
  const double max_range_m =
      options.range_for_clouds ? options.max_range_m : std::numeric_limits<double>::infinity();
  cloud.counts.pixels = set.points.size();
  std::vector<std::uint8_t> within_range;
  std::vector<Vec3d> within;   // world frame, points within range
  Eigen::AlignedBox3d bounds;  // of these
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    const Vec3f& p = set.points[i];
    const Vec3d q = set.origin + p.cast<double>();
    if (!p.allFinite()) {
      ++cloud.counts.invalid;
    } else if (q.isZero(0)) {
      ++cloud.counts.no_measurement;
    } else {
      cloud.source.push_back(static_cast<std::uint32_t>(i));
      within_range.push_back(q.norm() <= max_range_m);
      if (within_range.back()) bounds.extend(within.emplace_back(R * q));
    }
  }
  // Whole meters, so that a small cloud near zero keeps the exact coordinates of its file.
  cloud.origin = bulk_origin(within);
  cloud.points.reserve(cloud.source.size());
  for (const std::uint32_t i : cloud.source) {
    const Vec3d world = R * (set.origin + set.points[i].cast<double>());
    cloud.points.push_back((world - cloud.origin).cast<float>());
  }
  // Slightly larger than the bounds, so that rounding to float does not exclude the last point.
  const double extent_m = bounds.isEmpty() ? 0 : bounds.sizes().maxCoeff() * (1 + 1e-5) + 1e-5;
  const Vec3d center = bounds.isEmpty() ? Vec3d::Zero() : Vec3d(bounds.center() - cloud.origin);
  cloud.cube = make_cube(center, extent_m, options);
  // No cube can contain all points: use the cube around the bulk of them.
  if (cloud.cube.edge_m < extent_m) cloud.cube = make_cube(Vec3d::Zero(), extent_m, options);
  crop(cloud, within_range);
  if (cloud.counts.outside_cube > cloud.counts.kept)
    throw Error(
        fmt::format("frame {}: {} of {} points are outside the largest supported cube, which has "
                    "{:.1f} m edges and surrounds their center; expected coordinates in meters",
                    frame.name, cloud.counts.outside_cube, within.size(), cloud.cube.edge_m));
  return cloud;
}

}  // namespace

Cloud make_cloud(const Frame& frame, const Gravity& gravity, const CloudOptions& options) {
  check(options);
  return frame.is_cloud() ? cloud_of_points(frame, gravity, options)
                          : cloud_of_depth(frame, gravity, options);
}

std::string doubt_in_voxels(const Cloud& cloud, double voxel_size_m) {
  constexpr double kLeast_m = 0.25;  // smaller ones fit into the scenes of robots
  if (voxel_size_m < kLeast_m) return "";
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i]) box.extend(cloud.points[i]);
  if (box.isEmpty() || box.sizes().maxCoeff() >= voxel_size_m) return "";
  return fmt::format("{:g} m voxels are larger than the scene, which is {} across", voxel_size_m,
                     length_text(box.sizes().maxCoeff()));
}

Pose world_from_gravity(const Vec3d& gravity_sensor, bool depth_camera) {
  const Vec3d up = -gravity_sensor.normalized();
  const auto horizontal = [&](const Vec3d& axis) { return Vec3d(axis - axis.dot(up) * up); };
  Vec3d forward = horizontal(depth_camera ? Vec3d::UnitZ() : Vec3d::UnitX());
  // For a vertical view direction, "forward" is the top of the image (for clouds: y).
  if (forward.norm() < 1e-6)
    forward = horizontal(depth_camera ? Vec3d(-Vec3d::UnitY()) : Vec3d(Vec3d::UnitY()));
  forward.normalize();
  Pose pose = Pose::Identity();
  pose.linear().row(0) = forward;
  pose.linear().row(1) = up.cross(forward);
  pose.linear().row(2) = up;
  return pose;
}

}  // namespace planescope::planes
