#include "app/desktop/jobs/cloud_thumbnail.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

constexpr render::Rgba kBackground = {30, 33, 38, 255};
constexpr double kCutOff = 0.01;  // of the voxels, on each side: strays do not set the scale

struct Range {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double extent() const { return high - low; }
};

Range range_of(const std::vector<Vec3f>& points, int axis) {
  std::vector<float> values;
  values.reserve(points.size());
  for (const Vec3f& point : points) values.push_back(point[axis]);
  const auto at = [&](double share) {
    const auto nth = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + nth, values.end());
    return static_cast<double>(values[static_cast<std::size_t>(nth)]);
  };
  return {at(kCutOff), at(1 - kCutOff)};
}

}  // namespace

Image8 cloud_thumbnail(const debug::Run& run, int width) {
  const planes::VoxelCloud& voxels = run.subject->prepared.voxels;
  const int height = 3 * width / 4;
  Image8 image(width, height, 3);
  const auto paint = [&](int u, int v, render::Rgba color) {
    std::uint8_t* pixel = &image.data[3 * (static_cast<std::size_t>(v) * width + u)];
    pixel[0] = color.r;
    pixel[1] = color.g;
    pixel[2] = color.b;
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) paint(u, v, kBackground);
  if (voxels.points.empty()) return image;

  const Range x = range_of(voxels.points, 0), y = range_of(voxels.points, 1);
  // Half a voxel at least, so that a single one is no division by nothing.
  const double least = std::max(voxels.size_m, 1e-3);
  const double scale =
      0.94 * std::min(width / std::max(x.extent(), least), height / std::max(y.extent(), least));
  const int half = std::clamp(static_cast<int>(scale * voxels.size_m / 2), 0, width / 8);  // [px]
  std::vector<float> highest(static_cast<std::size_t>(width) * height,
                             -std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < voxels.points.size(); ++i) {
    const Vec3f& point = voxels.points[i];
    const double across = width / 2.0 + scale * (point.x() - x.middle());
    const double down = height / 2.0 - scale * (point.y() - y.middle());
    if (across < 0 || across >= width || down < 0 || down >= height) continue;
    const int u = static_cast<int>(across), v = static_cast<int>(down);
    const std::int32_t plane = run.segmentation.plane_of[i];
    const render::Rgba color = plane > 0 ? render::plane_color(plane) : render::leftover_color();
    for (int b = std::max(0, v - half); b <= std::min(height - 1, v + half); ++b)
      for (int a = std::max(0, u - half); a <= std::min(width - 1, u + half); ++a) {
        float& top = highest[static_cast<std::size_t>(b) * width + a];
        if (point.z() <= top) continue;
        top = point.z();
        paint(a, b, color);
      }
  }
  return image;
}

}  // namespace planescope::desktop
