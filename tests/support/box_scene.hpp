#pragma once

// A depth image with known planes: a floor and a wall, a step, a pole that hides the middle of
// both, a box too small to be listed; and a bush in front of the wall, which is not a plane.

#include <cmath>
#include <memory>
#include <utility>

#include "core/debug/replay/run.hpp"
#include "support/wall_scene.hpp"

namespace planescope::test {

enum BoxScenePlane { kFloor = 1, kWall, kStepFront, kStepTop, kPole, kSmallBox };

/// Depth [m] and true plane along the ray (x, y, 1), x right and y down.
inline std::pair<double, int> box_scene_at(double x, double y) {
  std::pair<double, int> nearest{1.2, kWall};
  const auto upright = [&](double z, double left, double right, double top, double foot,
                           int plane) {
    if (x * z >= left && x * z <= right && y * z >= top && y * z <= foot && z < nearest.first)
      nearest = {z, plane};
  };
  const auto level = [&](double height, double left, double right, double from, double to,
                         int plane) {
    const double z = y > 0 ? height / y : 0;
    if (z >= from && z <= to && x * z >= left && x * z <= right && z < nearest.first)
      nearest = {z, plane};
  };
  level(0.3, -9, 9, 0.1, 1.2, kFloor);
  upright(0.8, -0.3, 0, 0.15, 0.3, kStepFront);
  level(0.15, -0.3, 0, 0.8, 1.2, kStepTop);
  upright(0.9, 0.3, 0.367, 0.233, 0.3, kSmallBox);
  upright(0.5, 0.1, 0.12, -9, 9, kPole);
  if (x > -0.7 && x < -0.55 && y > -0.5 && y < -0.35)
    nearest = {0.7 + 0.02 * std::sin(200 * x) * std::sin(200 * y), 0};
  return nearest;
}

inline planes::PipelineOptions image_options() {
  planes::PipelineOptions options = wall_options();
  options.segment = planes::profile_options(planes::Profile::refined);
  options.segment.objective.worth_px = 14000;  // the small box is worth less
  return options;
}

inline std::shared_ptr<const debug::Subject> box_subject() {
  const Frame frame = depth_frame([](double x, double y) { return box_scene_at(x, y).first; });
  planes::SourceTruth truth;
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const int plane = box_scene_at((u - 319.5) / 400, (v - 239.5) / 400).second;
      const bool level = plane == kFloor || plane == kStepTop;
      truth.values.label.push_back(level ? 1 : 2);
      truth.values.instance.push_back(plane);
    }
  return debug::make_subject(frame, truth, image_options(), nullptr);
}

/// Computed once.
inline std::shared_ptr<const debug::Run> box_run() {
  static const auto run = debug::make_run(box_subject(), image_options());
  return run;
}

/// A pixel of the small box.
inline constexpr std::size_t kSmallBoxPixel = 357 * 640 + 467;

}  // namespace planescope::test
