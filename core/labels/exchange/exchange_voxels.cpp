#include <cmath>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/labels/exchange/exchange_files.hpp"
#include "core/planes/cloud/cloud.hpp"

// What a segmenter that works on voxels should have found: the voxels that ours makes, upright,
// with the majority of their points' labels (0 has no vote).
namespace planescope::labels {

FileBytes voxel_bytes(const LabelledPoints& points, double voxel_size_m) {
  if (!(voxel_size_m > 0) || !std::isfinite(voxel_size_m))
    throw Error("voxel size " + std::to_string(voxel_size_m) + ", expected more than 0 m");
  planes::Cloud cloud;
  cloud.T_world_sensor = points.T_world_sensor;
  const Eigen::Isometry3f T_world_sensor = points.T_world_sensor.cast<float>();
  double extent_m = 0;
  for (const Vec3f& point : points.points) {
    cloud.points.push_back(T_world_sensor * point);
    extent_m = std::max(extent_m, static_cast<double>(cloud.points.back().cwiseAbs().maxCoeff()));
  }
  cloud.kept.assign(cloud.points.size(), 1);  // labels are not cropped by range
  // About the sensor as the segmenter's cube, and doubled as that is, so that the grids agree.
  while (cloud.cube.edge_m <= 2 * extent_m) cloud.cube.edge_m *= 2;
  cloud.cube.min_corner = Vec3d::Constant(-cloud.cube.edge_m / 2);

  const planes::VoxelCloud voxels = planes::voxelize(cloud, voxel_size_m);
  PointSet set;
  set.points = voxels.points;
  if (!points.label.empty()) set.label = planes::vote_labels(voxels, points.label);
  set.instance = planes::vote_instances(voxels, points.instance);
  return io::ply_bytes(set);
}

}  // namespace planescope::labels
