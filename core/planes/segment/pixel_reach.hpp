#pragma once

// R11: of each pixel, how far from a plane it may lie and how far from the plane's own pixels.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/simd.hpp"
#include "core/planes/segment/noise.hpp"
#include "core/planes/segment/pixel_runs.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

inline constexpr int kMostReach_px = 20;

/// Per pixel of the depth image.
struct PixelReach {
  std::vector<double> tau_m;           // -1 where nothing was measured: no distance is within it
  std::vector<std::uint8_t> reach_px;  // 1 to kMostReach_px; 0 where nothing was measured
};

/// `reach_m`: what reach_px is on a surface that faces the camera.
PixelReach measure_pixel_reach(const PixelGrid& pixels,
                               std::span<const MeasuredRun> runs,
                               const Vec3d& sensor,
                               const NoiseModel& noise,
                               double reach_m,
                               Simd simd = best_simd());

}  // namespace planescope::planes
