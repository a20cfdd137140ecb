// Planes cut in two or more.

#include <algorithm>
#include <cassert>

#include "core/labels/edit/plane_edit.hpp"
#include "core/labels/model/parts.hpp"

namespace planescope::labels {
namespace {

/// Gives the pixels of each group from 1 on a plane of its own; group 0 keeps the id.
FrameLabels with_groups(const FrameLabels& labels,
                        const LabelGrid& grid,
                        int id,
                        std::span<const std::uint32_t> pixels,
                        std::span<const int> group,
                        int groups) {
  FrameLabels result = labels;
  LabelPlane& whole = editable_plane(result, id);
  if (groups < 2) return result;
  whole.confidence = 1;
  LabelPlane part = whole;
  std::vector<int> id_of{id};
  for (int k = 1; k < groups; ++k) {
    part.id = free_plane_id(result);
    id_of.push_back(part.id);
    add_plane(result, part);
  }
  for (std::size_t i = 0; i < pixels.size(); ++i)
    result.plane.data[pixels[i]] = static_cast<std::uint16_t>(id_of[group[i]]);
  refit_planes(result, grid, id_of);
  return result;
}

double area_m2(const LabelGrid& grid, const PixelSet& pixels, const Vec3d& normal) {
  double area = 0;
  for (const std::uint32_t pixel : pixels) area += grid.pixel_area_m2(pixel, &normal);
  return area;
}

/// The large part that each small one lies nearest to, in pixels.
std::vector<int> nearest_large_part(const LabelGrid& grid,
                                    const std::vector<PixelSet>& parts,
                                    const std::vector<std::uint8_t>& large) {
  // Rings grow from all large parts at once, over whatever lies between.
  std::vector<int> owner(grid.pixels(), -1);
  std::vector<std::uint32_t> front, next;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (large[k])
      for (const std::uint32_t pixel : parts[k]) {
        owner[pixel] = static_cast<int>(k);
        front.push_back(pixel);
      }
  std::vector<int> part_at(grid.pixels(), -1);
  std::vector<int> nearest(parts.size(), -1);
  int open = 0;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (large[k]) {
      nearest[k] = static_cast<int>(k);
    } else {
      ++open;
      for (const std::uint32_t pixel : parts[k]) part_at[pixel] = static_cast<int>(k);
    }
  while (open > 0 && !front.empty()) {
    next.clear();
    for (const std::uint32_t pixel : front)
      for_neighbours(pixel, grid.width, grid.height, [&](std::uint32_t other) {
        if (owner[other] >= 0) return;
        owner[other] = owner[pixel];
        next.push_back(other);
        if (const int part = part_at[other]; part >= 0 && nearest[part] < 0) {
          nearest[part] = owner[pixel];
          --open;
        }
      });
    front.swap(next);
  }
  return nearest;
}

}  // namespace

FrameLabels split_by_parts(
    const FrameLabels& labels, const LabelGrid& grid, int plane, double min_area_m2, int gap_px) {
  const LabelPlane* whole = find_plane(labels, plane);
  const PixelSet pixels = pixels_of_plane(labels, plane);
  const std::vector<PixelSet> parts = connected_parts(grid, pixels, gap_px);
  std::vector<double> area(parts.size(), 0);
  for (std::size_t k = 0; whole && k < parts.size(); ++k)
    area[k] = area_m2(grid, parts[k], whole->normal);
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(area) - area.begin());
  std::vector<std::uint8_t> large(parts.size(), 0);
  for (std::size_t k = 0; k < parts.size(); ++k) large[k] = k == largest || area[k] >= min_area_m2;

  const std::vector<int> nearest = nearest_large_part(grid, parts, large);
  std::vector<int> group_of(parts.size(), 0);
  int groups = 1;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (large[k] && k != largest) group_of[k] = groups++;
  PixelSet ordered;
  std::vector<int> group;
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (const std::uint32_t pixel : parts[k]) {
      ordered.push_back(pixel);
      group.push_back(group_of[nearest[k]]);
    }
  return with_groups(labels, grid, plane, ordered, group, groups);
}

FrameLabels split_by_side(const FrameLabels& labels,
                          const LabelGrid& grid,
                          int plane,
                          std::span<const float> side) {
  assert(side.size() == grid.pixels());
  const PixelSet pixels = pixels_of_plane(labels, plane);
  std::vector<int> group;
  int right = 0;
  for (const std::uint32_t pixel : pixels) {
    group.push_back(side[pixel] > 0 ? 1 : 0);
    right += group.back();
  }
  const bool cuts = right > 0 && right < static_cast<int>(pixels.size());
  return with_groups(labels, grid, plane, pixels, group, cuts ? 2 : 1);
}

std::vector<float> sides_of_line(int width, int height, const Vec2f& from, const Vec2f& to) {
  std::vector<float> sides;
  sides.reserve(static_cast<std::size_t>(width) * height);
  const Vec2f along = to - from;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2f p = Vec2f(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - from;
      sides.push_back(along.x() * p.y() - along.y() * p.x());  // y points down
    }
  return sides;
}

}  // namespace planescope::labels
