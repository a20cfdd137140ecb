// Gestures that finish a labeled plane.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
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
constexpr std::size_t kMostParts = 8;  // of a plane, to grow from
constexpr float kSameCosine = 0.98f;   // of the growing plane to the labeled one
constexpr int kPartsGap_px = 2;        // unmeasured gap that does not separate parts

/// A labeled plane and its candidates for growth.
struct Plane {
  WandField field;  // allowed: measured, unlabeled, in no other plane
  Sheet sheet;
  PixelSet pixels;
  std::vector<std::uint8_t> region;  // per pixel, 1 if it belongs to the plane

  bool takes(std::uint32_t i, float times = 1) const {
    return field.allowed[i] && !region[i] && field.lies_on(sheet, i, times);
  }
};

Plane plane_of(const FrameLabels& labels,
               const LabelGrid& grid,
               int id,
               const WandOptions& options) {
  const LabelPlane& known = editable_plane(labels, id);
  WandOptions free_only = options;
  free_only.take_labeled = false;
  Plane plane{make_wand_field(grid, &labels, free_only),
              {known.normal.cast<float>(), static_cast<float>(known.offset_m)},
              pixels_of_plane(labels, id),
              std::vector<std::uint8_t>(grid.pixels(), 0)};
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (labels.hv.data[i] != 0) plane.field.allowed[i] = 0;  // a class alone is also a label
  for (const std::uint32_t i : plane.pixels) plane.region[i] = 1;
  return plane;
}

constexpr double kRasterSpacings = 2;  // edge of the cells in which a cloud's holes are found
constexpr int kMostCells = 4000;       // cells along a side

/// A cloud's plane as cells, so that its holes can be found like those of an image.
class Raster {
 public:
  Raster(const LabelGrid& grid, const Sheet& sheet, const PixelSet& pixels) : grid_(grid) {
    across_ = sheet.normal.unitOrthogonal();
    up_ = sheet.normal.cross(across_);
    Eigen::AlignedBox2f bounds;
    for (const std::uint32_t i : pixels) bounds.extend(on_plane(i));
    const float extent = bounds.isEmpty() ? 0 : bounds.sizes().maxCoeff();
    edge_m_ = std::max(
        {static_cast<float>(kRasterSpacings * grid.spacing_m), extent / kMostCells, 1e-6f});
    if (!bounds.isEmpty()) corner_ = bounds.min() - Vec2f::Constant(edge_m_);
    size_ = static_cast<int>(extent / edge_m_) + 4;  // a border on each side, and one for rounding
    own_.assign(static_cast<std::size_t>(size_) * size_, 0);
    for (const std::uint32_t i : pixels)
      if (const int at = cell_of(i); at >= 0) own_[at] = 1;
    inside_ = own_;
    for (const PixelSet& hole : small_holes(own_, size_, size_, size_ * size_))
      for (const std::uint32_t cell : hole) inside_[cell] = 1;
  }

  /// Inside the plane's outline, and not in a cell on the outline. The outermost cells are empty.
  bool holds(std::uint32_t pixel) const {
    const int at = cell_of(pixel);
    return at >= 0 && inside_[at] && inside_[at - 1] && inside_[at + 1] && inside_[at - size_] &&
           inside_[at + size_];
  }

 private:
  Vec2f on_plane(std::uint32_t i) const {
    return {across_.dot(grid_.points[i]), up_.dot(grid_.points[i])};
  }
  int cell_of(std::uint32_t i) const {
    const Vec2f at = (on_plane(i) - corner_) / edge_m_;
    if (!(at.minCoeff() >= 0 && at.maxCoeff() < static_cast<float>(size_))) return -1;
    return static_cast<int>(at.y()) * size_ + static_cast<int>(at.x());
  }

  const LabelGrid& grid_;
  Vec3f across_, up_;
  Vec2f corner_ = Vec2f::Zero();
  float edge_m_ = 1;
  int size_ = 0;
  std::vector<std::uint8_t> own_, inside_;
};

/// Own points minus others, among points on the plane within two steps of a cloud's point.
int majority_in_cloud(const Plane& plane, const LabelGrid& grid, std::uint32_t point) {
  PixelSet disc{point};
  for (std::size_t k = 0, end = 1; k < end; ++k)
    for (const std::uint32_t j : grid.graph.around(disc[k])) {
      disc.push_back(j);
      if (k == 0) end = disc.size();
    }
  std::ranges::sort(disc);
  disc.erase(std::unique(disc.begin(), disc.end()), disc.end());
  int balance = 0;
  for (const std::uint32_t j : disc)
    if (plane.region[j] || plane.takes(j, kLoosely)) balance += plane.region[j] ? 1 : -1;
  return balance;
}

/// Own pixels minus others in a disc around a pixel. Opposite pixels count together or not at all,
/// so that neither the image's border nor unmeasured pixels bias a straight border.
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
  if (!grid.is_cloud())
    return fill_small_holes(labels, grid, id, options, static_cast<int>(grid.pixels()));
  const Plane plane = plane_of(labels, grid, id, options);
  const Raster raster(grid, plane.sheet, plane.pixels);
  Finish finish;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (plane.takes(i, kLoosely) && raster.holds(i)) finish.adds.push_back(i);
  return finish;
}

Finish fill_small_holes(const FrameLabels& labels,
                        const LabelGrid& grid,
                        int id,
                        const WandOptions& options,
                        int most_px) {
  const Plane plane = plane_of(labels, grid, id, options);
  Finish finish;
  for (const PixelSet& hole : small_holes(plane.region, grid.width, grid.height, most_px))
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
  const auto near = pixels_near(plane.pixels, grid, kSmooth_px);
  Finish finish;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) {
    if (!near[i] || (!plane.region[i] && !plane.takes(i, kLoosely))) continue;
    const int balance =
        grid.is_cloud() ? majority_in_cloud(plane, grid, i) : majority(plane, grid, i);
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
  // Run the wand from within each part; its rules for planes bound the result.
  std::vector<PixelSet> parts = connected_parts(grid, plane.pixels, kPartsGap_px);
  std::ranges::stable_sort(parts, std::ranges::greater{}, &PixelSet::size);
  if (parts.size() > kMostParts) parts.resize(kMostParts);
  std::vector<std::uint32_t> seeds;
  for (const PixelSet& part : parts) seeds.push_back(deepest_pixel(part, grid));
  FrameLabels others = labels;
  for (const std::uint32_t i : plane.pixels) others.plane.data[i] = 0;
  WandOptions free_only = options;
  free_only.take_labeled = false;
  const auto found = seeds.empty() ? std::nullopt : grow_plane(grid, &others, seeds, free_only);
  Finish finish;
  if (!found) return finish;
  const float cosine = found->plane.normal.cast<float>().dot(plane.sheet.normal);
  if ((grid.is_cloud() ? std::abs(cosine) : cosine) < kSameCosine) return finish;
  std::ranges::copy_if(found->pixels, std::back_inserter(finish.adds),
                       [&](std::uint32_t i) { return plane.field.allowed[i] && !plane.region[i]; });
  return finish;
}

Finish drop_specks(const FrameLabels& labels, const LabelGrid& grid, int id, double area_m2) {
  const LabelPlane& plane = editable_plane(labels, id);
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

void finish_plane(LabelDraft& draft, const LabelGrid& grid, int plane, const Finish& finish) {
  editable_plane(draft.labels, plane);
  paint(draft, grid, finish.adds, {.plane = plane}, PaintMode::add);
  paint(draft, grid, finish.takes, {.plane = plane}, PaintMode::subtract);
}

}  // namespace planescope::labels
