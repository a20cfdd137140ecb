#pragma once

// Sets of pixels of an image: their connected parts, distances within them, growing and filling.

#include <cstdint>
#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

/// Connected parts (four neighbours; of a cloud, its own) of every value in an image, by value; as
/// long as the largest value needs.
std::vector<int> count_fragments(const Image16& image, const LabelGrid* grid = nullptr);

/// Calls visit(neighbour) for the eight pixels around one, fewer at the image's border.
template <typename Visit>
void for_neighbours(std::uint32_t pixel, int width, int height, const Visit& visit) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  for (int v = y > 0 ? y - 1 : y; v <= y + 1 && v < height; ++v)
    for (int u = x > 0 ? x - 1 : x; u <= x + 1 && u < width; ++u)
      if (u != x || v != y) visit(static_cast<std::uint32_t>(v * width + u));
}

/// The same for the up to four pixels at its sides.
template <typename Visit>
void for_sides(std::uint32_t pixel, int width, int height, const Visit& visit) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  if (x > 0) visit(pixel - 1);
  if (x + 1 < width) visit(pixel + 1);
  if (y > 0) visit(pixel - static_cast<std::uint32_t>(width));
  if (y + 1 < height) visit(pixel + static_cast<std::uint32_t>(width));
}

/// Grows from `front` ring by ring, `rings` of them at most: reach(pixel, next) adds the pixels
/// that it takes to `next`.
template <typename Reach>
void grow_rings(std::vector<std::uint32_t> front, int rings, const Reach& reach) {
  std::vector<std::uint32_t> next;
  for (int ring = 0; ring < rings && !front.empty(); ++ring) {
    next.clear();
    for (const std::uint32_t pixel : front) reach(pixel, next);
    front.swap(next);
  }
}

/// for_neighbours() on a grid, whose neighbours are a cloud's own where it is one.
template <typename Visit>
void for_neighbours(std::uint32_t pixel, const LabelGrid& grid, const Visit& visit) {
  if (!grid.is_cloud()) return for_neighbours(pixel, grid.width, grid.height, visit);
  for (const std::uint32_t next : grid.graph.around(pixel)) visit(next);
}

/// Parts of a set: two pixels are in one part where steps to one of eight neighbours, each allowed
/// by `joins(from, to)`, lead from one to the other, over pixels of the set or not. In order of
/// their first pixels. `part_of`: per pixel of the image the part that reached it, -1 none.
template <typename Joins>
std::vector<PixelSet> flooded_parts(std::span<const std::uint32_t> pixels,
                                    const LabelGrid& grid,
                                    std::vector<int>& part_of,
                                    const Joins& joins) {
  part_of.assign(grid.pixels(), -1);
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
        for_neighbours(pixel, grid, [&](std::uint32_t next) {
          if (part_of[next] >= 0 || !joins(pixel, next)) return;
          part_of[next] = part;
          open.push_back(next);
        });
      }
    }
    parts[part_of[seed]].push_back(seed);
  }
  return parts;
}

/// Eight neighbours; parts that at most `gap_px` pixels without a measurement keep apart are one.
/// Of a cloud, its own neighbours. In order of their first pixels.
std::vector<PixelSet> connected_parts(const LabelGrid& grid,
                                      std::span<const std::uint32_t> pixels,
                                      int gap_px);

/// The pixel of a set that is farthest from all that is not in it; of several the first. The
/// image's border counts as outside. Of a cloud the point most steps from all that is not in the
/// set; of several the one nearest to their middle. `pixels` is not empty.
std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, const LabelGrid& grid);

/// Per pixel: 1 where one of the set is at most `distance_px` columns and rows away; of a cloud, at
/// most about as many spacings.
std::vector<std::uint8_t> pixels_near(std::span<const std::uint32_t> pixels,
                                      const LabelGrid& grid,
                                      int distance_px);

/// Parts of a set that lie at least `gap_px` (even) columns or rows apart, of a cloud about as many
/// spacings, whatever lies between.
std::vector<PixelSet> parts_apart(std::span<const std::uint32_t> pixels,
                                  const LabelGrid& grid,
                                  int gap_px);

/// Steps from each point of a region of a cloud to what is outside of it, 1 beside it; of a region
/// with no outside very many. `region_of`: per point, below 0 in none.
std::vector<int> steps_to_outside(const LabelGrid& cloud, std::span<const int> region_of);

/// Adds to `region` (1) what can be reached from `start` over pixels where `passable` is not 0,
/// by sides. Returns the pixels added.
std::vector<std::uint32_t> flood(const std::vector<std::uint8_t>& passable,
                                 int width,
                                 int height,
                                 std::span<const std::uint32_t> start,
                                 std::vector<std::uint8_t>& region);

/// Adds to `region` what lies within `reach` steps of it, of pixels where `passable` is not 0.
void spread(const std::vector<std::uint8_t>& passable,
            int width,
            int height,
            int reach,
            std::vector<std::uint8_t>& region);

/// The holes of a region with at most `most` pixels each, by their first pixels; none of them
/// touches the image's border.
std::vector<PixelSet> small_holes(const std::vector<std::uint8_t>& region,
                                  int width,
                                  int height,
                                  int most);

}  // namespace planescope::labels
