#include "core/pipeline/score.hpp"

namespace planescope {

Metrics score_frame(const FrameResult& result, const SourceTruth& truth) {
  const Cloud& cloud = result.cloud;
  const FrameTruth on_points = truth_on_points(truth.values, cloud.source);

  std::vector<Vec3f> points;
  std::vector<std::int32_t> true_planes, found_planes;
  std::vector<Label> true_labels, found_labels;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (voxel == kNoVoxel) continue;
    points.push_back(cloud.points[i]);
    true_planes.push_back(on_points.instance[i]);
    found_planes.push_back(result.plane_of[i]);
    true_labels.push_back(static_cast<Label>(on_points.label[i]));
    found_labels.push_back(result.classification.labels[voxel]);
  }
  std::vector<Vec3d> found_normals, true_normals;
  for (const PlaneRegion& plane : result.segmentation.planes)
    found_normals.push_back(plane.fit.normal);
  for (const Vec3d& normal : truth.normals)
    true_normals.push_back(cloud.T_world_sensor.linear() * normal);

  MetricsInput input;
  input.points = points;
  input.truth = true_planes;
  input.found = found_planes;
  input.found_normals = found_normals;
  input.truth_normals = true_normals;
  input.truth_labels = true_labels;
  input.found_labels = found_labels;
  return evaluate(input);
}

}  // namespace planescope
