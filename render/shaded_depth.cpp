// Depth as a picture of surfaces.

#include <cmath>

#include "render/paint.hpp"
#include "render/region_image.hpp"

namespace planescope::render {

Image8 shaded_depth(const Frame& frame) {
  const int width = frame.depth.width, height = frame.depth.height;
  Image8 image(width, height, 3);
  const auto point = [&](int x, int y) {
    const double z = frame.depth.at(x, y) * frame.depth_unit_m;
    return Vec3d((x - frame.intrinsics.cx) / frame.intrinsics.fx * z,
                 (y - frame.intrinsics.cy) / frame.intrinsics.fy * z, z);
  };
  const auto measured = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && frame.depth.at(x, y) != 0 &&
           frame.depth.at(x, y) != 65535;
  };
  constexpr int kReach = 4;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double grey = on_hatch(x, y, 8) ? 196 : 214;
      if (measured(x, y)) {
        grey = 150;
        const int x0 = measured(x - kReach, y) ? x - kReach : x;
        const int x1 = measured(x + kReach, y) ? x + kReach : x;
        const int y0 = measured(x, y - kReach) ? y - kReach : y;
        const int y1 = measured(x, y + kReach) ? y + kReach : y;
        const Vec3d normal = (point(x1, y) - point(x0, y)).cross(point(x, y1) - point(x, y0));
        if (normal.norm() > 0) {
          const Vec3d light = (-point(x, y).normalized() + Vec3d(-0.25, -0.35, 0)).normalized();
          grey = 70 + 165 * std::abs(normal.normalized().dot(light));
        }
      }
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<std::uint8_t>(grey);
    }
  }
  return image;
}

}  // namespace planescope::render
