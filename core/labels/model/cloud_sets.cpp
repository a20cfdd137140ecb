// The sets of pixel_sets.hpp on the points of a cloud: steps are from a point to its neighbours.

#include <algorithm>
#include <cassert>

#include "core/labels/model/pixel_sets.hpp"

namespace planescope::labels {
namespace {

constexpr int kNoOutside = 1 << 20;

}  // namespace

std::vector<int> steps_to_outside(const LabelGrid& cloud, std::span<const int> region_of) {
  std::vector<int> steps(region_of.size(), 0);
  std::vector<std::uint32_t> front, next;
  for (std::uint32_t i = 0; i < region_of.size(); ++i) {
    if (region_of[i] < 0) continue;
    const bool inside = std::ranges::all_of(
        cloud.graph.around(i), [&](std::uint32_t j) { return region_of[j] == region_of[i]; });
    if (inside) continue;
    steps[i] = 1;
    front.push_back(i);
  }
  for (int step = 2; !front.empty(); ++step) {
    next.clear();
    for (const std::uint32_t i : front)
      for (const std::uint32_t j : cloud.graph.around(i)) {
        if (region_of[j] != region_of[i] || steps[j] != 0) continue;
        steps[j] = step;
        next.push_back(j);
      }
    front.swap(next);
  }
  for (std::uint32_t i = 0; i < region_of.size(); ++i)
    if (region_of[i] >= 0 && steps[i] == 0) steps[i] = kNoOutside;
  return steps;
}

std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, const LabelGrid& grid) {
  assert(!pixels.empty());
  if (!grid.is_cloud()) return deepest_pixel(pixels, grid.width, grid.height);
  std::vector<int> region_of(grid.pixels(), -1);
  for (const std::uint32_t pixel : pixels) region_of[pixel] = 0;
  const std::vector<int> steps = steps_to_outside(grid, region_of);
  int most = 0;
  for (const std::uint32_t pixel : pixels) most = std::max(most, steps[pixel]);
  Vec3d sum = Vec3d::Zero();
  double count = 0;
  for (const std::uint32_t pixel : pixels)
    if (grid.measured[pixel]) {
      sum += grid.points[pixel].cast<double>();
      count += 1;
    }
  const Vec3d middle = sum / std::max(count, 1.0);
  std::uint32_t deepest = pixels.front();
  double least = -1;
  for (const std::uint32_t pixel : pixels) {
    if (steps[pixel] != most || !grid.measured[pixel]) continue;
    const double apart = (grid.points[pixel].cast<double>() - middle).squaredNorm();
    if (least >= 0 && apart >= least) continue;
    least = apart;
    deepest = pixel;
  }
  return deepest;
}

std::vector<std::uint8_t> pixels_near(std::span<const std::uint32_t> pixels,
                                      const LabelGrid& grid,
                                      int distance_px) {
  if (!grid.is_cloud()) return pixels_near(pixels, grid.width, grid.height, distance_px);
  std::vector<std::uint8_t> near(grid.pixels(), 0);
  for (const std::uint32_t pixel : pixels) near[pixel] = 1;
  std::vector<std::uint32_t> front(pixels.begin(), pixels.end()), next;
  for (int step = 0; step < (distance_px + 1) / kSpacingsOfStep; ++step) {
    next.clear();
    for (const std::uint32_t i : front)
      for (const std::uint32_t j : grid.graph.around(i)) {
        if (near[j]) continue;
        near[j] = 1;
        next.push_back(j);
      }
    front.swap(next);
  }
  return near;
}

}  // namespace planescope::labels
