#include "core/labels/review/review_regions.hpp"

#include <algorithm>

#include "core/labels/model/parts.hpp"

namespace planescope::labels {
namespace {

void find_parts(PairRegions& regions,
                const std::vector<std::uint64_t>& pairs,
                int width,
                int height) {
  regions.of_pixel.assign(pairs.size(), -1);
  std::vector<std::uint32_t> open;
  for (std::uint32_t seed = 0; seed < pairs.size(); ++seed) {
    if (pairs[seed] == 0) continue;
    if (regions.of_pixel[seed] < 0) {
      const int region = static_cast<int>(regions.pixels.size());
      regions.pixels.emplace_back();
      regions.of_pixel[seed] = region;
      open.assign(1, seed);
      while (!open.empty()) {
        const std::uint32_t pixel = open.back();
        open.pop_back();
        for_neighbours(pixel, width, height, [&](std::uint32_t next) {
          if (pairs[next] != pairs[seed] || regions.of_pixel[next] >= 0) return;
          regions.of_pixel[next] = region;
          open.push_back(next);
        });
      }
    }
    regions.pixels[regions.of_pixel[seed]].push_back(seed);
  }
}

/// Everything at once for all regions: a pass down and one up.
void measure_depth(PairRegions& regions, int width) {
  const std::size_t count = regions.pixels.size(), pixels = regions.of_pixel.size();
  regions.thickness_px.assign(count, 0);
  regions.deepest.assign(count, 0);
  std::vector<int> square(pixels, 0), steps(pixels, 0), most(count, 0);
  const auto value = [&](const std::vector<int>& of, std::size_t pixel, int dx, int dy) {
    const int x = static_cast<int>(pixel) % width + dx, y = static_cast<int>(pixel) / width + dy;
    if (x < 0 || x >= width || y < 0 || static_cast<std::size_t>(y) * width >= pixels) return 0;
    const std::size_t there = static_cast<std::size_t>(y) * width + x;
    return regions.of_pixel[there] == regions.of_pixel[pixel] ? of[there] : 0;
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    const int region = regions.of_pixel[i];
    if (region < 0) continue;
    const int left = value(square, i, -1, 0), up = value(square, i, 0, -1);
    square[i] = 1 + std::min({left, up, value(square, i, -1, -1)});
    steps[i] = 1 + std::min(value(steps, i, -1, 0), value(steps, i, 0, -1));
    regions.thickness_px[region] = std::max(regions.thickness_px[region], square[i]);
  }
  for (std::size_t i = pixels; i-- > 0;) {
    const int region = regions.of_pixel[i];
    if (region < 0) continue;
    steps[i] = 1 + std::min({steps[i] - 1, value(steps, i, 1, 0), value(steps, i, 0, 1)});
    if (steps[i] < most[region]) continue;
    most[region] = steps[i];
    regions.deepest[region] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace

PairRegions regions_of_pairs(const std::vector<std::uint64_t>& pairs, int width, int height) {
  PairRegions regions;
  find_parts(regions, pairs, width, height);
  measure_depth(regions, width);
  return regions;
}

}  // namespace planescope::labels
