#include "core/labels/wand/finish.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>

#include "core/labels/edit/operations.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand_field.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

constexpr int kSmooth_px = 3;          // radius of the disc whose majority counts
constexpr std::size_t kMostParts = 8;  // of a plane, that it grows from
constexpr float kSameCosine = 0.98f;   // of the plane that grows, to that which was labelled
constexpr int kPartsGap_px = 2;        // without a measurement, that keeps parts not apart

/// One plane of the labels, and what could be added to it.
struct Plane {
  WandField field;  // allowed: measured, unlabelled, of no other plane
  Sheet sheet;
  PixelSet pixels;
  std::vector<std::uint8_t> region;  // per pixel, 1 its own

  bool takes(std::uint32_t i, float times = 1) const {
    return field.allowed[i] && !region[i] && field.lies_on(sheet, i, times);
  }
};

void require_editable(const FrameLabels& labels, int id) {
  const LabelPlane* plane = find_plane(labels, id);
  if (!plane) throw Error("there is no plane P" + std::to_string(id));
  if (plane->locked) throw Error("P" + std::to_string(id) + " is locked");
}

Plane plane_of(const FrameLabels& labels,
               const LabelGrid& grid,
               int id,
               const WandOptions& options) {
  require_editable(labels, id);
  WandOptions free_only = options;
  free_only.take_labelled = false;
  const LabelPlane& known = *find_plane(labels, id);
  Plane plane{make_wand_field(grid, &labels, free_only),
              {known.normal.cast<float>(), static_cast<float>(known.offset_m)},
              pixels_of_plane(labels, id),
              std::vector<std::uint8_t>(grid.pixels(), 0)};
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (labels.hv.data[i] != 0) plane.field.allowed[i] = 0;  // a class alone is a label, too
  for (const std::uint32_t i : plane.pixels) plane.region[i] = 1;
  return plane;
}

/// Own pixels minus others in a disc around a pixel. Opposite places count together or not at all,
/// so that neither the image's border nor what was not measured tips a straight border.
int majority(const Plane& plane, const LabelGrid& grid, std::uint32_t pixel) {
  const int u = static_cast<int>(pixel) % grid.width, v = static_cast<int>(pixel) / grid.width;
  const auto at = [&](int x, int y) -> std::int64_t {
    if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) return -1;
    const std::int64_t i = std::int64_t{y} * grid.width + x;
    return grid.measured[static_cast<std::size_t>(i)] ? i : -1;
  };
  const auto vote = [&](std::int64_t i) {
    return plane.region[static_cast<std::size_t>(i)] ? 1 : -1;
  };
  int balance = vote(pixel);
  for (int dv = 0; dv <= kSmooth_px; ++dv)
    for (int du = -kSmooth_px; du <= kSmooth_px; ++du) {
      if (du * du + dv * dv > kSmooth_px * kSmooth_px + 1 || (dv == 0 && du <= 0)) continue;
      const std::int64_t one = at(u + du, v + dv), other = at(u - du, v - dv);
      if (one >= 0 && other >= 0) balance += vote(one) + vote(other);
    }
  return balance;
}

}  // namespace

Finish fill_holes(const FrameLabels& labels,
                  const LabelGrid& grid,
                  int id,
                  const WandOptions& options) {
  const Plane plane = plane_of(labels, grid, id, options);
  Finish finish;
  const int any = static_cast<int>(grid.pixels());
  for (const PixelSet& hole : small_holes(plane.region, grid.width, grid.height, any))
    std::ranges::copy_if(hole, std::back_inserter(finish.adds),
                         [&](std::uint32_t i) { return plane.takes(i, kLoosely); });
  std::ranges::sort(finish.adds);
  return finish;
}

Finish smooth_border(const FrameLabels& labels,
                     const LabelGrid& grid,
                     int id,
                     const WandOptions& options) {
  const Plane plane = plane_of(labels, grid, id, options);
  const auto near = pixels_near(plane.pixels, grid.width, grid.height, kSmooth_px);
  Finish finish;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) {
    if (!near[i] || (!plane.region[i] && !plane.takes(i, kLoosely))) continue;
    const int balance = majority(plane, grid, i);
    if (plane.region[i] && balance < 0) finish.takes.push_back(i);
    if (!plane.region[i] && balance > 0) finish.adds.push_back(i);
  }
  if (finish.takes.size() == plane.pixels.size()) finish.takes.clear();  // a line, all border
  return finish;
}

Finish grow_to_border(const FrameLabels& labels,
                      const LabelGrid& grid,
                      int id,
                      const WandOptions& options) {
  const Plane plane = plane_of(labels, grid, id, options);
  // The wand, from within each part: what it finds is bounded as its own planes are.
  std::vector<PixelSet> parts = connected_parts(grid, plane.pixels, kPartsGap_px);
  std::ranges::stable_sort(parts, std::ranges::greater{}, &PixelSet::size);
  if (parts.size() > kMostParts) parts.resize(kMostParts);
  std::vector<std::uint32_t> seeds;
  for (const PixelSet& part : parts) seeds.push_back(deepest_pixel(part, grid.width, grid.height));
  FrameLabels others = labels;
  for (const std::uint32_t i : plane.pixels) others.plane.data[i] = 0;
  WandOptions free_only = options;
  free_only.take_labelled = false;
  const auto found = seeds.empty() ? std::nullopt : grow_plane(grid, &others, seeds, free_only);
  Finish finish;
  if (!found || found->plane.normal.cast<float>().dot(plane.sheet.normal) < kSameCosine)
    return finish;
  std::ranges::copy_if(found->pixels, std::back_inserter(finish.adds),
                       [&](std::uint32_t i) { return plane.field.allowed[i] && !plane.region[i]; });
  return finish;
}

Finish drop_specks(const FrameLabels& labels, const LabelGrid& grid, int id, double area_m2) {
  require_editable(labels, id);
  const LabelPlane& plane = *find_plane(labels, id);
  std::vector<PixelSet> parts = connected_parts(grid, pixels_of_plane(labels, id), kPartsGap_px);
  Finish finish;
  if (parts.empty()) return finish;
  parts.erase(std::ranges::max_element(parts, {}, &PixelSet::size));
  for (const PixelSet& part : parts)
    if (grid.area_m2(part, &plane.normal) < area_m2)
      finish.takes.insert(finish.takes.end(), part.begin(), part.end());
  std::ranges::sort(finish.takes);
  return finish;
}

FrameLabels finished(const FrameLabels& labels,
                     const LabelGrid& grid,
                     int plane,
                     const Finish& finish) {
  require_editable(labels, plane);
  const Paint paint{.plane = plane};
  return painted(painted(labels, grid, finish.adds, paint, PaintMode::add), grid, finish.takes,
                 paint, PaintMode::subtract);
}

}  // namespace planescope::labels
