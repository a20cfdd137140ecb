// Connected parts, distances, flood fill and holes of pixel sets.

#include "core/labels/model/pixel_sets.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "core/model/disjoint_sets.hpp"

namespace planescope::labels {

std::vector<int> count_fragments(const Image16& image, const LabelGrid* grid) {
  if (image.empty()) return {};
  DisjointSets sets(image.pixels());
  const auto join_if_same = [&](std::uint32_t a, std::uint32_t b) {
    if (image.data[a] == image.data[b]) sets.join(a, b);
  };
  const auto width = static_cast<std::uint32_t>(image.width);
  for (std::uint32_t i = 0; i < image.pixels(); ++i) {
    if (grid && grid->is_cloud()) {
      for (const std::uint32_t j : grid->graph.around(i))
        if (j < i) join_if_same(i, j);
      continue;
    }
    if (i % width > 0) join_if_same(i - 1, i);
    if (i >= width) join_if_same(i - width, i);
  }
  std::vector<int> counts(*std::ranges::max_element(image.data) + 1, 0);
  for (std::uint32_t i = 0; i < sets.size(); ++i)
    if (sets.root(i) == i) ++counts[image.data[i]];
  return counts;
}

namespace {

constexpr std::uint16_t kFar = std::numeric_limits<std::uint16_t>::max();
constexpr int kNoOutside = 1 << 20;

}  // namespace

std::vector<PixelSet> connected_parts(const LabelGrid& grid,
                                      std::span<const std::uint32_t> pixels,
                                      int gap_px) {
  if (grid.is_cloud()) {
    std::vector<std::uint8_t> own(grid.pixels(), 0);
    for (const std::uint32_t pixel : pixels) own[pixel] = 1;
    std::vector<int> part_of;
    return flooded_parts(pixels, grid, part_of,
                         [&](std::uint32_t, std::uint32_t to) { return own[to] != 0; });
  }
  // The parts grow into the gaps, ring by ring, and join if they meet within a short enough path.
  // `steps` is the distance into the gap.
  std::vector<std::uint16_t> steps(grid.pixels(), kFar);
  DisjointSets sets(grid.pixels());
  std::vector<std::uint32_t> reached(pixels.begin(), pixels.end());
  for (const std::uint32_t pixel : reached) steps[pixel] = 0;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const std::uint32_t pixel = reached[k];
    if (2 * steps[pixel] >= gap_px) break;  // the other side covers the rest
    for_neighbors(pixel, grid.width, grid.height, [&](std::uint32_t other) {
      if (grid.measured[other] || steps[other] != kFar) return;
      steps[other] = static_cast<std::uint16_t>(steps[pixel] + 1);
      sets.join(other, pixel);
      reached.push_back(other);
    });
  }
  for (const std::uint32_t pixel : reached)
    for_neighbors(pixel, grid.width, grid.height, [&](std::uint32_t other) {
      if (other > pixel || steps[other] == kFar || steps[pixel] + steps[other] > gap_px) return;
      sets.join(pixel, other);
    });

  std::vector<PixelSet> parts;
  std::vector<int> part_of_root(grid.pixels(), -1);
  for (const std::uint32_t pixel : pixels) {
    int& part = part_of_root[sets.root(pixel)];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[part].push_back(pixel);
  }
  return parts;
}

namespace {

std::uint32_t deepest_in_image(std::span<const std::uint32_t> pixels, int width, int height) {
  // Distance to the outside in one pass down and one up, with a border of zeros around the image.
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

std::vector<std::uint8_t> near_in_image(std::span<const std::uint32_t> pixels,
                                        int width,
                                        int height,
                                        int distance_px) {
  // Along the rows, then along the columns: a separable square.
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

}  // namespace

std::vector<int> steps_to_outside(const LabelGrid& cloud, std::span<const int> region_of) {
  std::vector<int> steps(region_of.size(), 0);
  std::vector<std::uint32_t> border;
  for (std::uint32_t i = 0; i < region_of.size(); ++i) {
    if (region_of[i] < 0) continue;
    const bool inside = std::ranges::all_of(
        cloud.graph.around(i), [&](std::uint32_t j) { return region_of[j] == region_of[i]; });
    if (inside) continue;
    steps[i] = 1;
    border.push_back(i);
  }
  grow_rings(std::move(border), kNoOutside, [&](std::uint32_t i, auto& next) {
    for (const std::uint32_t j : cloud.graph.around(i)) {
      if (region_of[j] != region_of[i] || steps[j] != 0) continue;
      steps[j] = steps[i] + 1;
      next.push_back(j);
    }
  });
  for (std::uint32_t i = 0; i < region_of.size(); ++i)
    if (region_of[i] >= 0 && steps[i] == 0) steps[i] = kNoOutside;
  return steps;
}

std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, const LabelGrid& grid) {
  assert(!pixels.empty());
  if (!grid.is_cloud()) return deepest_in_image(pixels, grid.width, grid.height);
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
  if (!grid.is_cloud()) return near_in_image(pixels, grid.width, grid.height, distance_px);
  std::vector<std::uint8_t> near(grid.pixels(), 0);
  for (const std::uint32_t pixel : pixels) near[pixel] = 1;
  grow_rings({pixels.begin(), pixels.end()}, (distance_px + 1) / kSpacingsOfStep,
             [&](std::uint32_t i, auto& next) {
               for (const std::uint32_t j : grid.graph.around(i))
                 if (!std::exchange(near[j], std::uint8_t{1})) next.push_back(j);
             });
  return near;
}

std::vector<PixelSet> parts_apart(std::span<const std::uint32_t> pixels,
                                  const LabelGrid& grid,
                                  int gap_px) {
  // Grown by half the gap, parts closer than the gap touch.
  const auto grown = pixels_near(pixels, grid, std::max(0, gap_px / 2 - 1));
  std::vector<int> part_of;
  return flooded_parts(pixels, grid, part_of,
                       [&](std::uint32_t, std::uint32_t to) { return grown[to] != 0; });
}

std::vector<std::uint32_t> flood(const std::vector<std::uint8_t>& passable,
                                 int width,
                                 int height,
                                 std::span<const std::uint32_t> start,
                                 std::vector<std::uint8_t>& region) {
  // Scanline fill: fill a whole run, then search the rows above and below it.
  std::vector<std::uint32_t> added;
  std::vector<std::uint32_t> open(start.begin(), start.end());
  const auto free = [&](std::size_t i) { return passable[i] && !region[i]; };
  while (!open.empty()) {
    const std::uint32_t pixel = open.back();
    open.pop_back();
    if (!free(pixel)) continue;
    const std::size_t row = pixel / width * static_cast<std::size_t>(width);
    std::size_t first = pixel, end = pixel + std::size_t{1};
    while (first > row && free(first - 1)) --first;
    while (end < row + width && free(end)) ++end;
    for (std::size_t i = first; i < end; ++i) {
      region[i] = 1;
      added.push_back(static_cast<std::uint32_t>(i));
    }
    const auto search = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
        if (free(i) && (i + 1 == to || !free(i + 1))) open.push_back(static_cast<std::uint32_t>(i));
    };
    if (row > 0) search(first - width, end - width);
    if (row + width < static_cast<std::size_t>(width) * height) search(first + width, end + width);
  }
  return added;
}

void spread(const std::vector<std::uint8_t>& passable,
            int width,
            int height,
            int reach,
            std::vector<std::uint8_t>& region) {
  std::vector<std::uint32_t> front;
  for (std::size_t i = 0; i < region.size(); ++i)
    if (region[i]) front.push_back(static_cast<std::uint32_t>(i));
  grow_rings(std::move(front), reach, [&](std::uint32_t i, auto& next) {
    for_sides(i, width, height, [&](std::uint32_t j) {
      if (!passable[j] || region[j]) return;
      region[j] = 1;
      next.push_back(j);
    });
  });
}

std::vector<PixelSet> small_holes(const std::vector<std::uint8_t>& region,
                                  int width,
                                  int height,
                                  int most) {
  std::vector<PixelSet> holes;
  PixelSet hole;
  enum : std::uint8_t { kOpen, kRegion, kThisHole, kNoHole };
  std::vector<std::uint8_t> seen = region;
  for (std::size_t first = 1; first < region.size(); ++first) {
    if (seen[first] || !region[first - 1]) continue;  // a hole begins right of the region
    hole.assign(1, static_cast<std::uint32_t>(first));
    seen[first] = kThisHole;
    bool closed = true;
    for (std::size_t k = 0; k < hole.size() && closed; ++k) {
      const std::uint32_t i = hole[k];
      const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
      if (x == 0 || y == 0 || x + 1 == width || y + 1 == height) {
        closed = false;
        break;
      }
      for (const std::uint32_t j : {i - 1, i + 1, i - width, i + width}) {
        if (seen[j] == kNoHole) closed = false;
        if (seen[j] != kOpen) continue;
        seen[j] = kThisHole;
        hole.push_back(j);
      }
      closed = closed && hole.size() <= static_cast<std::size_t>(most);
    }
    // Holes that are too large remain partly visited; anything that touches them is no hole either.
    for (const std::uint32_t i : hole) seen[i] = closed ? kRegion : kNoHole;
    if (closed) holes.push_back(hole);
  }
  return holes;
}

}  // namespace planescope::labels
