#pragma once

// Pixel sets of an image: connected parts, distances, growing and filling.

#include <cstdint>
#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

/// Connected parts (four neighbors, or the graph of a cloud) of every value in an image, indexed by
/// value up to the largest one.
std::vector<int> count_fragments(const Image16& image, const LabelGrid* grid = nullptr);

/// Calls visit(neighbor) for the eight pixels around one, fewer at the image's border.
template <typename Visit>
void for_neighbors(std::uint32_t pixel, int width, int height, const Visit& visit) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  for (int v = y > 0 ? y - 1 : y; v <= y + 1 && v < height; ++v)
    for (int u = x > 0 ? x - 1 : x; u <= x + 1 && u < width; ++u)
      if (u != x || v != y) visit(static_cast<std::uint32_t>(v * width + u));
}

/// The same for up to four pixels at its sides.
template <typename Visit>
void for_sides(std::uint32_t pixel, int width, int height, const Visit& visit) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  if (x > 0) visit(pixel - 1);
  if (x + 1 < width) visit(pixel + 1);
  if (y > 0) visit(pixel - static_cast<std::uint32_t>(width));
  if (y + 1 < height) visit(pixel + static_cast<std::uint32_t>(width));
}

/// Grows from `front` ring by ring, up to `rings` of them: reach(pixel, next) appends the pixels
/// that it adds to `next`.
template <typename Reach>
void grow_rings(std::vector<std::uint32_t> front, int rings, const Reach& reach) {
  std::vector<std::uint32_t> next;
  for (int ring = 0; ring < rings && !front.empty(); ++ring) {
    next.clear();
    for (const std::uint32_t pixel : front) reach(pixel, next);
    front.swap(next);
  }
}

/// for_neighbors() on a grid: of the image, or of a cloud's graph.
template <typename Visit>
void for_neighbors(std::uint32_t pixel, const LabelGrid& grid, const Visit& visit) {
  if (!grid.is_cloud()) return for_neighbors(pixel, grid.width, grid.height, visit);
  for (const std::uint32_t next : grid.graph.around(pixel)) visit(next);
}

/// Parts of a set: two pixels are in one part if a path of neighbor steps, each allowed by
/// `joins(from, to)`, connects them, within the set or not. Ordered by first pixel. `part_of`: per
/// pixel of the image, the part that reached it, -1 none.
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
        for_neighbors(pixel, grid, [&](std::uint32_t next) {
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

/// Parts by eight neighbors, or by the graph of a cloud. Parts separated by at most `gap_px`
/// unmeasured pixels are joined. Ordered by first pixel.
std::vector<PixelSet> connected_parts(const LabelGrid& grid,
                                      std::span<const std::uint32_t> pixels,
                                      int gap_px);

/// The pixel of a set farthest from everything outside it, or the first of several. Outside the
/// image counts as outside. In a cloud, the point with the most steps to the outside, or of several
/// the one nearest to their middle. `pixels` must not be empty.
std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, const LabelGrid& grid);

/// Per pixel: 1 if a pixel of the set is at most `distance_px` columns and rows away; in a cloud,
/// at most about as many spacings.
std::vector<std::uint8_t> pixels_near(std::span<const std::uint32_t> pixels,
                                      const LabelGrid& grid,
                                      int distance_px);

/// Parts of a set that are at least `gap_px` (even) columns or rows apart, or in a cloud about as
/// many spacings, whatever is between them.
std::vector<PixelSet> parts_apart(std::span<const std::uint32_t> pixels,
                                  const LabelGrid& grid,
                                  int gap_px);

/// Steps from each point of a cloud's region to the outside, 1 at the border; a very large number
/// if there is no outside. `region_of`: per point, negative for none.
std::vector<int> steps_to_outside(const LabelGrid& cloud, std::span<const int> region_of);

/// Adds to `region` (1) all pixels reachable from `start` through sides over pixels with nonzero
/// `passable`. Returns the added pixels.
std::vector<std::uint32_t> flood(const std::vector<std::uint8_t>& passable,
                                 int width,
                                 int height,
                                 std::span<const std::uint32_t> start,
                                 std::vector<std::uint8_t>& region);

/// Adds to `region` all pixels within `reach` steps of it through pixels with nonzero `passable`.
void spread(const std::vector<std::uint8_t>& passable,
            int width,
            int height,
            int reach,
            std::vector<std::uint8_t>& region);

/// The holes of a region with at most `most` pixels each, ordered by first pixel. Holes never touch
/// the image's border.
std::vector<PixelSet> small_holes(const std::vector<std::uint8_t>& region,
                                  int width,
                                  int height,
                                  int most);

}  // namespace planescope::labels
