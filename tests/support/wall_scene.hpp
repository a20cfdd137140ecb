#pragma once

// Depth images of scenes in front of a level camera, for methods that work on pixels.

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/model/frame.hpp"
#include "core/model/random.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::test {

/// `depth_m(x, y)`: depth along the ray (x, y, 1), x right and y down; 0: none. Noise is added to
/// 1/z [1/m].
inline Frame depth_frame(const std::function<double(double, double)>& depth_m,
                         double noise = 0.002) {
  Frame frame;
  frame.depth = Image16(640, 480);
  frame.depth_unit_m = 0.0002;
  frame.intrinsics = {640, 480, 400, 400, 319.5, 239.5};
  frame.gravity = Gravity{Vec3d::UnitY(), GravitySource::option, 1, "down"};
  Random random(1);
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const double z = depth_m((u - 319.5) / 400, (v - 239.5) / 400);
      const double w = 1 / z + noise * random.normal();
      if (z > 0) frame.depth.at(u, v) = static_cast<std::uint16_t>(std::lround(1 / w / 0.0002));
    }
  return frame;
}

/// A floor 60 cm below the camera and a wall 1.2 m ahead; their crease is at y = 0.5.
inline Frame floor_and_wall() {
  return depth_frame([](double, double y) { return std::min(1.2, 0.6 / std::max(y, 1e-3)); });
}

inline planes::PipelineOptions wall_options() {
  planes::PipelineOptions options;
  options.cloud.max_range_m = 4;
  options.classifier = "pca";
  return options;
}

inline planes::FrameResult result_of(
    const Frame& frame, const std::function<void(planes::SegmentOptions&)>& change = {}) {
  planes::PipelineOptions options = wall_options();
  if (change) change(options.segment);
  return planes::run_frame(frame, options, planes::make_pca_classifier().get());
}

/// Includes all decisions that led to the result.
inline std::pair<planes::FrameResult, planes::Trace> traced_result_of(const Frame& frame,
                                                                      int threads = 1) {
  planes::PipelineOptions options = wall_options();
  options.threads = threads;
  planes::Trace trace;
  planes::FrameResult result =
      run_frame(frame, options, planes::make_pca_classifier().get(), nullptr, &trace);
  return {std::move(result), std::move(trace)};
}

/// Plane of a pixel; 0: none.
inline int plane_at(const planes::FrameResult& result, int u, int v) {
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (result.cloud.source[i] == static_cast<std::uint32_t>(v * 640 + u))
      return result.plane_of[i];
  return 0;
}

}  // namespace planescope::test
