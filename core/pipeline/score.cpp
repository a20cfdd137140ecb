#include "core/pipeline/score.hpp"

#include <algorithm>

#include "core/evaluate/plane_match.hpp"

namespace planescope {
namespace {

/// Truth on the points, its planes numbered from 1 on without gaps: ids of labels may be any.
struct DenseTruth {
  FrameTruth on_points;
  std::vector<Vec3d> normals;  // by dense id - 1, sensor frame; zero where unknown
};

DenseTruth dense_truth(const FrameResult& result, const SourceTruth& truth) {
  DenseTruth dense;
  dense.on_points = truth_on_points(truth.values, result.cloud.source);
  std::vector<std::int32_t> ids;
  for (const std::int32_t id : dense.on_points.instance)
    if (id > 0) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (std::int32_t& id : dense.on_points.instance)
    if (id > 0)
      id =
          static_cast<std::int32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin()) + 1;
  for (const std::int32_t id : ids) {
    const auto k = static_cast<std::size_t>(id) - 1;
    dense.normals.push_back(k < truth.normals.size() ? truth.normals[k] : Vec3d::Zero());
  }
  return dense;
}

Verdict verdict_of(std::int32_t truth, std::int32_t found, std::span<const int> found_of) {
  if (truth < 0) return Verdict::unscored;
  if (truth == 0) return found > 0 ? Verdict::invented : Verdict::right;
  if (found <= 0) return Verdict::missed;
  return found_of[static_cast<std::size_t>(truth) - 1] == found ? Verdict::right
                                                                : Verdict::wrong_plane;
}

}  // namespace

Metrics score_frame(const FrameResult& result, const SourceTruth& truth) {
  const Cloud& cloud = result.cloud;
  const DenseTruth dense = dense_truth(result, truth);

  std::vector<Vec3f> points;
  std::vector<std::int32_t> true_planes, found_planes;
  std::vector<Label> true_labels, found_labels;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (voxel == kNoVoxel) continue;
    points.push_back(cloud.points[i]);
    true_planes.push_back(dense.on_points.instance[i]);
    found_planes.push_back(result.plane_of[i]);
    true_labels.push_back(static_cast<Label>(dense.on_points.label[i]));
    found_labels.push_back(result.classification.labels[voxel]);
  }
  std::vector<Vec3d> found_normals, true_normals;
  for (const PlaneRegion& plane : result.segmentation.planes)
    found_normals.push_back(plane.fit.normal);
  for (const Vec3d& normal : dense.normals)
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

JudgedFrame judge_frame(const FrameResult& result, const SourceTruth& truth) {
  JudgedFrame judged;
  const DenseTruth dense = dense_truth(result, truth);
  judged.true_plane = dense.on_points.instance;
  std::vector<std::int32_t> scored = judged.true_plane;
  for (std::size_t i = 0; i < scored.size(); ++i)
    if (result.voxels.voxel_of[i] == kNoVoxel) scored[i] = -1;
  judged.found_of = found_of_truth(count_truth_overlap(scored, result.plane_of));
  judged.found_of.resize(dense.normals.size(), 0);  // planes that were cropped have no partner
  for (std::size_t i = 0; i < scored.size(); ++i) {
    const std::int32_t found = result.plane_of[i];
    Verdict verdict = verdict_of(scored[i], found, judged.found_of);
    if (verdict == Verdict::right && found > 0) {
      const auto label = static_cast<Label>(dense.on_points.label[i]);
      const Label taken_for = result.segmentation.planes[static_cast<std::size_t>(found) - 1].label;
      if (label != Label::unknown && label != taken_for) verdict = Verdict::wrong_class;
    }
    judged.verdict.push_back(verdict);
  }
  return judged;
}

}  // namespace planescope
