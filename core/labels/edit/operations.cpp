// Operations on a draft of labels: paint, classify, join, split, remove and set flags.

#include "core/labels/edit/operations.hpp"

#include <algorithm>
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

/// The current or new label of a pixel.
struct Value {
  std::uint16_t plane = 0;
  std::uint8_t hv = 0;

  bool operator==(const Value&) const = default;
};

bool is_plane(int id) { return id > 0 && id < kPlaneIgnore; }

void set_class(LabelDraft& draft, LabelPlane& plane, Label label) {
  plane.label = label;
  for (const std::uint32_t pixel : pixels_of_plane(draft.labels, plane.id))
    draft.set(pixel, plane.id, static_cast<std::uint8_t>(label));
}

Label class_of_pixels(const LabelGrid& grid, std::span<const std::uint32_t> pixels) {
  return class_of_tilt(fit_plane(grid, pixels).tilt_deg);
}

}  // namespace

const LabelPlane* find_plane(const FrameLabels& labels, int id) {
  const auto found = std::ranges::find(labels.planes, id, &LabelPlane::id);
  return found == labels.planes.end() ? nullptr : &*found;
}

const LabelPlane& editable_plane(const FrameLabels& labels, int id) {
  const LabelPlane* plane = find_plane(labels, id);
  if (!plane) throw Error("no plane P" + std::to_string(id));
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
  if (free >= kPlaneIgnore) throw Error("there are already 65534 planes, the maximum");
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

std::size_t paint(LabelDraft& draft,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> pixels,
                  const Paint& paint,
                  PaintMode mode) {
  FrameLabels& labels = draft.labels;
  assert(paint.plane >= 0 && paint.plane <= kPlaneIgnore);
  assert(labels.plane.pixels() == grid.pixels());
  LabelPlane* plane = plane_in(labels, paint.plane);
  if (plane && plane->locked) return 0;
  std::vector<std::uint8_t> keeps(kPlaneIgnore + 1, 0);  // by plane: 1 if its pixels are protected
  for (const LabelPlane& each : labels.planes) keeps[each.id] = each.locked || each.hidden;
  Value value{static_cast<std::uint16_t>(paint.plane),
              static_cast<std::uint8_t>(plane ? plane->label : paint.label)};
  if (paint.plane == kPlaneIgnore) value.hv = kHvIgnore;
  PixelSet changed;
  bool moves = false;  // changes planes, not only classes
  for (const std::uint32_t pixel : pixels) {
    const Value was{labels.plane.data[pixel], labels.hv.data[pixel]};
    if (!grid.measured[pixel] || keeps[was.plane]) continue;
    const bool changes = mode == PaintMode::over  ? was != value
                         : mode == PaintMode::add ? was == Value{} && value != Value{}
                                                  : was == value && was != Value{};
    if (!changes) continue;
    changed.push_back(pixel);
    moves |= mode == PaintMode::subtract || was.plane != value.plane;
  }
  if (changed.empty()) return 0;
  if (is_plane(paint.plane) && !plane) {
    LabelPlane made;
    made.id = paint.plane;
    made.label = paint.label == Label::unknown ? class_of_pixels(grid, changed) : paint.label;
    made.origin = paint.origin;
    value.hv = static_cast<std::uint8_t>(made.label);
    plane = &add_plane(labels, made);
  }
  if (plane && moves) plane->confidence = 1;  // a person has looked at it
  if (mode == PaintMode::subtract) value = {};
  for (const std::uint32_t pixel : changed) draft.set(pixel, value.plane, value.hv);
  return changed.size();
}

void fit_planes(LabelDraft& draft, const LabelGrid& grid) {
  if (!draft.unfitted.empty()) refit_planes(draft.labels, grid, draft.unfitted);
  draft.unfitted.clear();
}

void set_gravity(LabelDraft& draft, const Gravity& gravity) {
  draft.labels.gravity = gravity;
  for (LabelPlane& plane : draft.labels.planes)
    if (plane.label == Label::unknown && !plane.locked)
      set_class(draft, plane, class_of_tilt(tilt_of(plane.normal, gravity)));
}

void set_class(LabelDraft& draft, int id, Label label) {
  LabelPlane& plane = editable_plane(draft.labels, id);
  plane.confidence = 1;
  set_class(draft, plane, label);
}

void remove_plane(LabelDraft& draft, int id) {
  editable_plane(draft.labels, id);
  for (const std::uint32_t pixel : pixels_of_plane(draft.labels, id)) draft.set(pixel, 0, 0);
  std::erase_if(draft.labels.planes, [id](const LabelPlane& plane) { return plane.id == id; });
  std::erase(draft.unfitted, id);
}

void join_planes(LabelDraft& draft, int into, int from) {
  editable_plane(draft.labels, from);
  LabelPlane& plane = editable_plane(draft.labels, into);
  if (into == from) return;
  plane.confidence = 1;
  for (const std::uint32_t pixel : pixels_of_plane(draft.labels, from))
    draft.set(pixel, into, static_cast<std::uint8_t>(plane.label));
  draft.unfitted.insert(draft.unfitted.end(), {into, from});  // even without pixels
}

void set_flag(LabelDraft& draft, int id, PlaneFlag flag, bool on) {
  LabelPlane* plane = plane_in(draft.labels, id);
  if (!plane) throw Error("no plane P" + std::to_string(id));
  (flag == PlaneFlag::locked ? plane->locked : plane->hidden) = on;
}

void take_segmentation(LabelDraft& draft,
                       const LabelGrid& grid,
                       std::span<const std::int32_t> plane_of,
                       std::span<const Label> label_of_plane) {
  assert(plane_of.size() == grid.pixels());
  FrameLabels& labels = draft.labels;
  std::vector<std::uint8_t> kept(kPlaneIgnore + 1, 0);
  kept[kPlaneIgnore] = 1;
  for (const LabelPlane& plane : labels.planes) kept[plane.id] = plane.locked || plane.hidden;
  std::erase_if(labels.planes, [&](const LabelPlane& plane) { return !kept[plane.id]; });

  // Keep the segmentation's ids, except those already in use.
  const std::size_t planes = label_of_plane.size();
  std::vector<int> id_of(planes + 1, 0);
  std::vector<PixelSet> pixels(planes + 1);
  for (std::uint32_t i = 0; i < plane_of.size(); ++i)
    if (!kept[labels.plane.data[i]])
      pixels[grid.measured[i] ? std::max(0, plane_of[i]) : 0].push_back(i);
  for (const bool taken : {false, true})
    for (std::size_t k = 1; k <= planes; ++k) {
      if (pixels[k].empty() || (k < kPlaneIgnore && !kept[k]) == taken) continue;
      LabelPlane plane;
      plane.id = id_of[k] = taken ? free_plane_id(labels) : static_cast<int>(k);
      plane.label = label_of_plane[k - 1];
      if (plane.label == Label::unknown) plane.label = class_of_pixels(grid, pixels[k]);
      plane.origin = LabelOrigin::algorithm;
      add_plane(labels, plane);
      draft.unfitted.push_back(plane.id);  // also if it replaces one with the same pixels
    }
  for (std::size_t k = 0; k <= planes; ++k) {
    const LabelPlane* plane = find_plane(labels, id_of[k]);
    const auto hv = static_cast<std::uint8_t>(plane ? plane->label : Label::unknown);
    for (const std::uint32_t i : pixels[k]) draft.set(i, id_of[k], hv);
  }
}

// Planes cut into two or more parts.

namespace {

/// Moves the pixels of each group from 1 on to a new plane; group 0 keeps the id.
void split(LabelDraft& draft,
           int id,
           std::span<const std::uint32_t> pixels,
           std::span<const int> group,
           int groups) {
  LabelPlane& whole = editable_plane(draft.labels, id);
  if (groups < 2) return;
  whole.confidence = 1;
  LabelPlane part = whole;
  std::vector<int> id_of{id};
  for (int k = 1; k < groups; ++k) {
    part.id = free_plane_id(draft.labels);
    id_of.push_back(part.id);
    add_plane(draft.labels, part);
  }
  for (std::size_t i = 0; i < pixels.size(); ++i)
    draft.set(pixels[i], id_of[group[i]], draft.labels.hv.data[pixels[i]]);
}

/// The large part nearest to each small part, in pixels.
std::vector<int> nearest_large_part(const LabelGrid& grid,
                                    const std::vector<PixelSet>& parts,
                                    const std::vector<std::uint8_t>& large) {
  // Rings grow from all large parts at once, over any pixels in between.
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
    for_neighbors(i, grid, [&](std::uint32_t other) {
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

void split_by_parts(
    LabelDraft& draft, const LabelGrid& grid, int plane, double min_area_m2, int gap_px) {
  const Vec3d normal = editable_plane(draft.labels, plane).normal;
  const PixelSet pixels = pixels_of_plane(draft.labels, plane);
  const std::vector<PixelSet> parts = connected_parts(grid, pixels, gap_px);
  std::vector<double> area(parts.size(), 0);
  for (std::size_t k = 0; k < parts.size(); ++k) area[k] = grid.area_m2(parts[k], &normal);
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
  split(draft, plane, ordered, group, groups);
}

void split_by_side(LabelDraft& draft, int plane, std::span<const float> side) {
  assert(side.size() == draft.labels.plane.pixels());
  const PixelSet pixels = pixels_of_plane(draft.labels, plane);
  std::vector<int> group;
  for (const std::uint32_t pixel : pixels) group.push_back(side[pixel] > 0 ? 1 : 0);
  const auto right = std::ranges::count(group, 1);
  split(draft, plane, pixels, group, right > 0 && right < std::ssize(pixels) ? 2 : 1);
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
