// Label operations as pure functions: paint, classify, join, split, remove and set flags.

#include "core/labels/edit/operations.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <utility>

#include "core/labels/model/pixel_sets.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

LabelPlane* plane_in(FrameLabels& labels, int id) {
  return const_cast<LabelPlane*>(find_plane(std::as_const(labels), id));
}

LabelPlane& editable_plane(FrameLabels& labels, int id) {
  return const_cast<LabelPlane&>(labels::editable_plane(std::as_const(labels), id));
}

/// What a pixel has, or is given.
struct Value {
  std::uint16_t plane = 0;
  std::uint8_t hv = 0;

  bool operator==(const Value&) const = default;
};

/// What painting writes into a pixel.
Value value_of(const FrameLabels& labels, const Paint& paint) {
  if (paint.plane == kPlaneIgnore) return {kPlaneIgnore, kHvIgnore};
  const LabelPlane* plane = find_plane(labels, paint.plane);
  return {static_cast<std::uint16_t>(paint.plane),
          static_cast<std::uint8_t>(plane ? plane->label : paint.label)};
}

bool is_plane(int id) { return id > 0 && id < kPlaneIgnore; }

void set_class(FrameLabels& labels, LabelPlane& plane, Label label) {
  plane.label = label;
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i)
    if (labels.plane.data[i] == plane.id) labels.hv.data[i] = static_cast<std::uint8_t>(label);
}

void classify_by_tilt(FrameLabels& labels, const LabelGrid& grid, LabelPlane& plane) {
  set_class(labels, plane,
            class_of_tilt(fit_plane(grid, pixels_of_plane(labels, plane.id)).tilt_deg));
}

}  // namespace

const LabelPlane* find_plane(const FrameLabels& labels, int id) {
  const auto found = std::ranges::find(labels.planes, id, &LabelPlane::id);
  return found == labels.planes.end() ? nullptr : &*found;
}

const LabelPlane& editable_plane(const FrameLabels& labels, int id) {
  const LabelPlane* plane = find_plane(labels, id);
  if (!plane) throw Error("there is no plane P" + std::to_string(id));
  if (plane->locked) throw Error("P" + std::to_string(id) + " is locked");
  return *plane;
}

int free_plane_id(const FrameLabels& labels) {
  std::vector<int> ids;
  for (const LabelPlane& plane : labels.planes) ids.push_back(plane.id);
  std::ranges::sort(ids);
  int free = 1;
  for (const int id : ids)
    if (id == free) ++free;
  if (free >= kPlaneIgnore) throw Error("there are 65534 planes already, no more are possible");
  return free;
}

PixelSet pixels_of_plane(const FrameLabels& labels, int id) {
  PixelSet pixels;
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i)
    if (labels.plane.data[i] == id) pixels.push_back(static_cast<std::uint32_t>(i));
  return pixels;
}

LabelPlane& add_plane(FrameLabels& labels, const LabelPlane& plane) {
  const auto place = std::ranges::lower_bound(labels.planes, plane.id, {}, &LabelPlane::id);
  return *labels.planes.insert(place, plane);
}

PixelSet changed_by_painting(const FrameLabels& labels,
                             const LabelGrid& grid,
                             std::span<const std::uint32_t> pixels,
                             const Paint& paint,
                             PaintMode mode) {
  assert(paint.plane >= 0 && paint.plane <= kPlaneIgnore);
  assert(labels.plane.pixels() == grid.pixels());
  if (const LabelPlane* plane = find_plane(labels, paint.plane); plane && plane->locked) return {};
  std::vector<std::uint8_t> keeps(kPlaneIgnore + 1, 0);  // its pixels, by plane
  for (const LabelPlane& plane : labels.planes) keeps[plane.id] = plane.locked || plane.hidden;
  const Value value = value_of(labels, paint);
  PixelSet changed;
  for (const std::uint32_t pixel : pixels) {
    const Value was{labels.plane.data[pixel], labels.hv.data[pixel]};
    if (!grid.measured[pixel] || keeps[was.plane]) continue;
    const bool changes = mode == PaintMode::over  ? was != value
                         : mode == PaintMode::add ? was == Value{} && value != Value{}
                                                  : was == value && was != Value{};
    if (changes) changed.push_back(pixel);
  }
  return changed;
}

FrameLabels painted(const FrameLabels& labels,
                    const LabelGrid& grid,
                    std::span<const std::uint32_t> pixels,
                    const Paint& paint,
                    PaintMode mode) {
  FrameLabels result = labels;
  const PixelSet changed = changed_by_painting(labels, grid, pixels, paint, mode);
  if (changed.empty()) return result;
  const bool is_new = is_plane(paint.plane) && !find_plane(labels, paint.plane);
  if (is_new) {
    LabelPlane plane;
    plane.id = paint.plane;
    plane.label = paint.label;
    plane.origin = paint.origin;
    add_plane(result, plane);
  }
  const Value becomes = mode == PaintMode::subtract ? Value{} : value_of(labels, paint);
  std::vector<std::uint8_t> touched(kPlaneIgnore + 1, 0);
  std::vector<int> refit;
  const auto touch = [&](int id) {
    if (!is_plane(id) || std::exchange(touched[id], 1)) return;
    refit.push_back(id);
  };
  for (const std::uint32_t pixel : changed) {
    const int was = std::exchange(result.plane.data[pixel], becomes.plane);
    result.hv.data[pixel] = becomes.hv;
    if (was == becomes.plane) continue;
    touch(was);
    touch(becomes.plane);
  }
  if (refit.empty()) return result;
  refit_planes(result, grid, refit);
  if (LabelPlane* plane = is_plane(paint.plane) ? plane_in(result, paint.plane) : nullptr) {
    plane->confidence = 1;  // somebody has looked at it
    if (is_new && paint.label == Label::unknown) classify_by_tilt(result, grid, *plane);
  }
  return result;
}

FrameLabels with_gravity(const FrameLabels& labels, const Gravity& gravity) {
  FrameLabels after = labels;
  after.gravity = gravity;
  for (LabelPlane& plane : after.planes)
    if (plane.label == Label::unknown && !plane.locked)
      set_class(after, plane, class_of_tilt(tilt_of(plane.normal, gravity)));
  return after;
}

FrameLabels with_class(const FrameLabels& labels, int id, Label label) {
  FrameLabels result = labels;
  LabelPlane& plane = editable_plane(result, id);
  plane.confidence = 1;
  set_class(result, plane, label);
  return result;
}

FrameLabels without_plane(const FrameLabels& labels, int id) {
  FrameLabels result = labels;
  editable_plane(result, id);
  for (std::size_t i = 0; i < result.plane.data.size(); ++i)
    if (result.plane.data[i] == id) result.plane.data[i] = result.hv.data[i] = 0;
  std::erase_if(result.planes, [id](const LabelPlane& plane) { return plane.id == id; });
  return result;
}

FrameLabels joined(const FrameLabels& labels, const LabelGrid& grid, int into, int from) {
  FrameLabels result = labels;
  editable_plane(result, from);
  LabelPlane& plane = editable_plane(result, into);
  if (into == from) return result;
  plane.confidence = 1;
  for (std::size_t i = 0; i < result.plane.data.size(); ++i)
    if (result.plane.data[i] == from) {
      result.plane.data[i] = static_cast<std::uint16_t>(into);
      result.hv.data[i] = static_cast<std::uint8_t>(plane.label);
    }
  refit_planes(result, grid, std::array{into, from});
  return result;
}

FrameLabels with_flag(const FrameLabels& labels, int id, PlaneFlag flag, bool on) {
  FrameLabels result = labels;
  LabelPlane* plane = plane_in(result, id);
  if (!plane) throw Error("there is no plane P" + std::to_string(id));
  (flag == PlaneFlag::locked ? plane->locked : plane->hidden) = on;
  return result;
}

FrameLabels from_segmentation(const FrameLabels& labels,
                              const LabelGrid& grid,
                              std::span<const std::int32_t> plane_of,
                              std::span<const Label> label_of_plane) {
  assert(plane_of.size() == grid.pixels());
  FrameLabels result = labels;
  std::vector<std::uint8_t> kept(kPlaneIgnore + 1, 0);
  kept[kPlaneIgnore] = 1;
  for (const LabelPlane& plane : labels.planes) kept[plane.id] = plane.locked || plane.hidden;
  std::erase_if(result.planes, [&](const LabelPlane& plane) { return !kept[plane.id]; });

  // Ids as the segmentation has them, but for those that are taken.
  const std::size_t planes = label_of_plane.size();
  std::vector<int> id_of(planes + 1, 0);
  std::vector<int> seen(planes + 1, 0);
  for (std::size_t i = 0; i < plane_of.size(); ++i)
    if (plane_of[i] > 0 && grid.measured[i] && !kept[labels.plane.data[i]]) seen[plane_of[i]] = 1;
  for (const bool taken : {false, true})
    for (std::size_t k = 1; k <= planes; ++k) {
      if (!seen[k] || (k < kPlaneIgnore && !kept[k]) == taken) continue;
      LabelPlane plane;
      plane.id = id_of[k] = taken ? free_plane_id(result) : static_cast<int>(k);
      plane.label = label_of_plane[k - 1];
      plane.origin = LabelOrigin::algorithm;
      add_plane(result, plane);
    }
  std::vector<int> changed;
  for (const int id : id_of)
    if (id > 0) changed.push_back(id);

  for (std::size_t i = 0; i < plane_of.size(); ++i) {
    if (kept[labels.plane.data[i]]) continue;
    const int k = grid.measured[i] ? std::max(0, plane_of[i]) : 0;
    result.plane.data[i] = static_cast<std::uint16_t>(id_of[k]);
    result.hv.data[i] = k > 0 ? static_cast<std::uint8_t>(label_of_plane[k - 1]) : 0;
  }
  if (changed.empty()) return result;
  refit_planes(result, grid, changed);
  for (const int id : changed)
    if (LabelPlane* plane = plane_in(result, id); plane->label == Label::unknown)
      classify_by_tilt(result, grid, *plane);
  return result;
}

// Planes cut in two or more.

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

/// The large part that each small one lies nearest to, in pixels.
std::vector<int> nearest_large_part(const LabelGrid& grid,
                                    const std::vector<PixelSet>& parts,
                                    const std::vector<std::uint8_t>& large) {
  // Rings grow from all large parts at once, over whatever lies between.
  std::vector<int> owner(grid.pixels(), -1);
  std::vector<std::uint32_t> front;
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
  grow_rings(std::move(front), std::numeric_limits<int>::max(), [&](std::uint32_t i, auto& next) {
    if (open == 0) return;
    for_neighbours(i, grid, [&](std::uint32_t other) {
      if (owner[other] >= 0) return;
      owner[other] = owner[i];
      next.push_back(other);
      if (const int part = part_at[other]; part >= 0 && nearest[part] < 0) {
        nearest[part] = owner[i];
        --open;
      }
    });
  });
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
    area[k] = grid.area_m2(parts[k], &whole->normal);
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
      group.push_back(group_of[nearest[k] < 0 ? largest : static_cast<std::size_t>(nearest[k])]);
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
