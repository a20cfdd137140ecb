#pragma once

// Runs on synthetic clouds in which every point is its own voxel and pixel.

#include <numeric>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "support/scenes.hpp"

namespace planescope::test {

inline std::shared_ptr<debug::Subject> subject_of(std::vector<Vec3f> points,
                                                  std::vector<Label> labels,
                                                  const planes::Cube& cube) {
  auto subject = std::make_shared<debug::Subject>();
  planes::PreparedFrame& prepared = subject->prepared;
  prepared.cloud.T_world_sensor.translation() = Vec3d(-1.5, 0, 1);
  prepared.cloud.cube = cube;
  prepared.cloud.points = points;
  prepared.cloud.kept.assign(points.size(), 1);
  subject->point_of_source.resize(points.size());
  std::iota(subject->point_of_source.begin(), subject->point_of_source.end(), 0u);
  prepared.cloud.source = prepared.voxels.voxel_of = subject->point_of_source;
  prepared.voxels.count.assign(points.size(), 1);
  prepared.classification.margins.assign(points.size(), 1.0f);
  prepared.classification.labels = std::move(labels);
  subject->frame.cloud = PointSet{};
  subject->frame.cloud->points = points;
  prepared.voxels.points = std::move(points);
  return subject;
}

inline std::shared_ptr<const debug::Run> run_of_cloud(std::uint64_t seed,
                                                      const planes::SegmentOptions& options) {
  LabeledCloud cloud = random_cloud(seed);
  planes::PipelineOptions pipeline;
  pipeline.segment = options;
  return debug::make_run(subject_of(std::move(cloud.points), std::move(cloud.labels), cloud.cube),
                         pipeline);
}

/// Stairs with their exact labels and true planes.
inline std::shared_ptr<debug::Subject> stairs_subject(int index,
                                                      double noise_m,
                                                      int points = 2048) {
  lab::StairsOptions options;
  options.noise_m = noise_m;
  options.points = points;
  const lab::Stairs stairs = lab::make_stairs(index, options);
  std::vector<Label> labels;
  for (const std::uint8_t label : stairs.cloud.label)
    labels.push_back(label == 2 ? Label::v : Label::h);
  const auto subject =
      subject_of(stairs.cloud.points, std::move(labels), cube_around(stairs.cloud.points));
  subject->voxel_truth.label = stairs.cloud.label;
  subject->voxel_truth.plane = stairs.cloud.instance;
  for (const std::int32_t plane : stairs.cloud.instance)
    subject->voxel_truth.plane_count = std::max(subject->voxel_truth.plane_count, plane);
  return subject;
}

inline std::shared_ptr<const debug::Run> run_of_stairs(const planes::SegmentOptions& options,
                                                       double noise_m,
                                                       int index = 0,
                                                       int points = 2048) {
  planes::PipelineOptions pipeline;
  pipeline.segment = options;
  return debug::make_run(stairs_subject(index, noise_m, points), pipeline);
}

}  // namespace planescope::test
