#include "core/labels/model/pixel_depth.hpp"

#include <algorithm>
#include <cassert>

#include "core/labels/model/parts.hpp"

namespace planescope::labels {

std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, int width, int height) {
  assert(!pixels.empty());
  // Steps to the outside, by one pass down and one up; a frame of zeros around the image.
  const int stride = width + 2;
  std::vector<int> steps(static_cast<std::size_t>(stride) * (height + 2), 0);
  const auto place = [&](std::uint32_t pixel) {
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    return (y + 1) * stride + x + 1;
  };
  for (const std::uint32_t pixel : pixels) {
    const int at = place(pixel);
    steps[at] = 1 + std::min(steps[at - 1], steps[at - stride]);
  }
  std::uint32_t deepest = pixels.front();
  for (auto pixel = pixels.rbegin(); pixel != pixels.rend(); ++pixel) {
    const int at = place(*pixel);
    steps[at] = std::min({steps[at], 1 + steps[at + 1], 1 + steps[at + stride]});
    if (steps[at] >= steps[place(deepest)]) deepest = *pixel;
  }
  return deepest;
}

std::vector<std::uint8_t> pixels_near(std::span<const std::uint32_t> pixels,
                                      int width,
                                      int height,
                                      int distance_px) {
  // Along the rows, then along the columns: a square is both.
  const auto image = static_cast<std::size_t>(width) * height;
  std::vector<std::uint8_t> along(image, 0), near(image, 0);
  for (const std::uint32_t pixel : pixels) {
    const int x = static_cast<int>(pixel) % width, row = static_cast<int>(pixel) - x;
    const int from = std::max(0, x - distance_px), to = std::min(width - 1, x + distance_px);
    std::fill(along.begin() + row + from, along.begin() + row + to + 1, std::uint8_t{1});
  }
  for (int y = 0; y < height; ++y) {
    const int from = std::max(0, y - distance_px), to = std::min(height - 1, y + distance_px);
    for (int v = from; v <= to; ++v)
      for (int x = 0; x < width; ++x) near[y * width + x] |= along[v * width + x];
  }
  return near;
}

std::vector<PixelSet> parts_apart(std::span<const std::uint32_t> pixels,
                                  int width,
                                  int height,
                                  int gap_px) {
  // Grown by half of the gap, parts that are nearer touch.
  const auto grown = pixels_near(pixels, width, height, std::max(0, gap_px / 2 - 1));
  std::vector<int> part_of(grown.size(), -1);
  std::vector<PixelSet> parts;
  std::vector<std::uint32_t> open;
  for (const std::uint32_t seed : pixels) {
    if (part_of[seed] < 0) {
      const int part = static_cast<int>(parts.size());
      parts.emplace_back();
      part_of[seed] = part;
      open.assign(1, seed);
      while (!open.empty()) {
        const std::uint32_t pixel = open.back();
        open.pop_back();
        for_neighbours(pixel, width, height, [&](std::uint32_t next) {
          if (!grown[next] || part_of[next] >= 0) return;
          part_of[next] = part;
          open.push_back(next);
        });
      }
    }
    parts[part_of[seed]].push_back(seed);
  }
  return parts;
}

}  // namespace planescope::labels
