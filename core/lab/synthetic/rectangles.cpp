#include "core/lab/synthetic/rectangles.hpp"

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/farthest_points.hpp"

namespace planescope::lab {

SurfacePoints sample_surface(std::span<const Rectangle> rectangles,
                             std::size_t count,
                             const Mat3d& turn,
                             Random& random) {
  double area = 0;
  for (const Rectangle& r : rectangles) area += r.area();
  // Dense: four times what is asked for, at least 32768 points, spread evenly by area.
  const std::size_t dense = std::max<std::size_t>(32768, 4 * count);
  SurfacePoints all;
  for (std::size_t k = 0; k < rectangles.size(); ++k) {
    const Rectangle& r = rectangles[k];
    const auto n =
        static_cast<std::size_t>(std::lround(static_cast<double>(dense) * r.area() / area));
    for (std::size_t i = 0; i < n; ++i) {
      double u = random.uniform(), v = random.uniform();
      if (r.halved && u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      all.points.push_back((turn * (r.corner + u * r.side_u + v * r.side_v)).cast<float>());
      all.rectangle.push_back(static_cast<std::uint32_t>(k));
    }
  }
  if (count == 0) return all;
  SurfacePoints even;
  for (const std::uint32_t i : farthest_points(all.points, count)) {
    even.points.push_back(all.points[i]);
    even.rectangle.push_back(all.rectangle[i]);
  }
  return even;
}

}  // namespace planescope::lab
