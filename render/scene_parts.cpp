#include "render/scene_parts.hpp"

#include <algorithm>
#include <cmath>

#include "render/palette.hpp"

namespace planescope {
namespace {

constexpr Rgba kGravity{90, 60, 140, 255};
constexpr std::size_t kMostPlanesInLegend = 8;

/// Splats as wide as the voxels they stand for.
float splat_size(const FrameResult& result) {
  const std::size_t voxels = result.voxels.points.size();
  const bool grid = voxels < result.cloud.counts.kept;
  return grid ? 0.02F : 0.01F;
}

/// Indices of planes, those with most points first.
std::vector<std::size_t> by_size(const Segmentation& segmentation) {
  std::vector<std::size_t> order(segmentation.planes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return segmentation.planes[a].points > segmentation.planes[b].points;
  });
  return order;
}

}  // namespace

Rgba with_alpha(Rgba color, std::uint8_t alpha) {
  color.a = alpha;
  return color;
}

Rgba mix(Rgba a, Rgba b, double share_b) {
  const auto blend = [&](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>(std::lround(x + share_b * (y - x)));
  };
  return {blend(a.r, b.r), blend(a.g, b.g), blend(a.b, b.b), 255};
}

Rgba color_of(int plane_id, std::span<const int> color_of_plane) {
  const auto index = static_cast<std::size_t>(plane_id - 1);
  return plane_color(index < color_of_plane.size() ? color_of_plane[index] : plane_id);
}

RobustBounds robust_bounds(std::span<const Vec3f> points) {
  RobustBounds bounds;
  if (points.empty()) return bounds;
  std::vector<float> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    const auto at = [&](double share) {
      const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + k, values.end());
      return values[static_cast<std::size_t>(k)];
    };
    bounds.low[axis] = at(0.01);
    bounds.high[axis] = at(0.99);
  }
  return bounds;
}

void add_gravity(const FrameResult& result, DrawList& list) {
  const RobustBounds bounds = robust_bounds(result.voxels.points);
  const float extent = bounds.diagonal();
  const float length = std::clamp(0.12F * extent, 0.1F, 2.0F);
  const Vec3f from(bounds.low.x(), bounds.high.y(), bounds.high.z());
  const Vec3f to = from - Vec3f(0, 0, length);
  list.arrows.push_back({from, to, kGravity, 3});
  const bool sure = result.gravity.source != GravitySource::estimate &&
                    result.gravity.source != GravitySource::assumed;
  std::string text = "gravity";
  if (!sure) text += std::string(", ") + to_string(result.gravity.source);
  list.labels.push_back({from + Vec3f(0, 0, 0.15F * length), text, kGravity, 13, true});
}

DrawPoints voxel_points(const FrameResult& result) {
  DrawPoints points;
  points.positions = result.voxels.points;
  points.size_m = splat_size(result);
  return points;
}

std::string percent(std::size_t part, std::size_t whole) {
  if (whole == 0) return "0 %";
  const double value = 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  const long tenths = std::lround(10 * value);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " %";
}

void add_plane_legend(const FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list) {
  using Mark = LegendEntry::Mark;
  const auto& planes = result.segmentation.planes;
  const std::vector<std::size_t> order = by_size(result.segmentation);
  for (std::size_t i = 0; i < std::min(order.size(), kMostPlanesInLegend); ++i) {
    const PlaneRegion& plane = planes[order[i]];
    list.legend.push_back({Mark::box, color_of(plane.id, color_of_plane),
                           std::to_string(plane.id) +
                               (plane.label == Label::h ? "  h  " : "  v  ") +
                               std::to_string(plane.points) + " voxels"});
  }
  if (order.size() > kMostPlanesInLegend)
    list.legend.push_back({Mark::box, kSceneFaded,
                           std::to_string(order.size() - kMostPlanesInLegend) + " smaller planes"});
}

}  // namespace planescope
