#pragma once

// Subjects of random clouds, without recordings.

#include <memory>

#include "core/debug/replay/run.hpp"
#include "support/scenes.hpp"

namespace planescope::test {

inline std::shared_ptr<debug::Subject> subject_of(const LabeledCloud& cloud) {
  auto subject = std::make_shared<debug::Subject>();
  planes::PreparedFrame& prepared = subject->prepared;
  prepared.cloud.T_world_sensor.translation() = Vec3d(-1.5, 0, 1);
  prepared.cloud.cube = cloud.cube;
  prepared.voxels.points = cloud.points;
  subject->frame.cloud = PointSet{};
  prepared.classification.labels = cloud.labels;
  prepared.classification.margins.assign(cloud.labels.size(), 1.0f);
  return subject;
}

inline planes::PipelineOptions options_of(planes::Profile profile) {
  planes::PipelineOptions options;
  options.segment = planes::profile_options(profile);
  return options;
}

/// A stair with three steps of 16 cm, with points every 2 cm and its truth: treads 1, 3, 5 are h,
/// risers 2, 4 are v. Exact, or with noise along each normal.
inline std::shared_ptr<debug::Subject> stair_subject(double noise_m = 0) {
  LabeledCloud cloud;
  debug::VoxelTruth truth;
  Random random(5);
  const auto add = [&](const Vec3d& p, const Vec3d& normal, Label label, int plane) {
    cloud.points.push_back((p + noise_m * random.normal() * normal).cast<float>());
    cloud.labels.push_back(label);
    truth.label.push_back(static_cast<std::uint8_t>(label));
    truth.plane.push_back(plane);
  };
  for (int step = 0; step < 3; ++step)
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 15; ++j)
        add({0.3 * step + 0.02 * j + 0.01, 0.02 * i, 0.16 * step}, Vec3d::UnitZ(), Label::h,
            2 * step + 1);
      for (int j = 0; step > 0 && j < 8; ++j)
        add({0.3 * step, 0.02 * i, 0.16 * step - 0.02 * j - 0.01}, Vec3d::UnitX(), Label::v,
            2 * step);
    }
  truth.plane_count = 5;
  cloud.cube = cube_around(cloud.points);
  auto subject = subject_of(cloud);
  subject->voxel_truth = truth;
  return subject;
}

}  // namespace planescope::test
