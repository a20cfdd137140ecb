#pragma once

// How noisy a depth image is, and which way its surface faces: by plane fits in small windows.
// Internal to core/labels.

#include <cstdint>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::labels {

/// On a plane inverse depth is linear in the ray (x, y, 1), and stereo measures it equally well at
/// any range.
struct InverseDepth {
  int width = 0, height = 0;
  std::vector<Vec2d> rays;    // per pixel
  std::vector<double> per_m;  // 1 / z; 0 where not measured
};

struct DepthSurface {
  double noise = 0;            // standard deviation of the measured inverse depth [1/m]
  std::vector<Vec3f> normals;  // unit, towards the sensor; zero where too little is measured around
};

/// The normals' windows end at depth edges and grow with the noise.
DepthSurface measure_surface(const InverseDepth& depth, double focal_px);

}  // namespace planescope::labels
