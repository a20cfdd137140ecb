#include "core/io/open3d/timed_stages.hpp"

#include <open3d/geometry/Octree.h>
#include <open3d/geometry/PointCloud.h>

#include <memory>

namespace planescope::open3d {

std::function<void()> voxel_down_sample(const planes::Cloud& cloud, double voxel_size_m) {
  const auto theirs = std::make_shared<::open3d::geometry::PointCloud>();
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i]) theirs->points_.push_back(cloud.points[i].cast<double>());
  return [theirs, voxel_size_m] { theirs->VoxelDownSample(voxel_size_m); };
}

std::function<void()> pointer_octree(std::span<const Vec3f> points, const planes::Cube& cube) {
  const auto theirs = std::make_shared<::open3d::geometry::PointCloud>();
  for (const Vec3f& p : points) theirs->points_.push_back(p.cast<double>());
  return [theirs, depth = static_cast<std::size_t>(cube.max_depth)] {
    ::open3d::geometry::Octree octree(depth);
    octree.ConvertFromPointCloud(*theirs, 0.0);
  };
}

}  // namespace planescope::open3d
