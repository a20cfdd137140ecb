#include "render/framing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "core/model/disjoint_sets.hpp"

namespace planescope::render {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kMargin = 0.92;  // share of the half view that may be filled, on each side

/// Evenly all around (Fibonacci's lattice on the sphere).
Vec3d direction(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count;
  const double turn = std::numbers::pi * (1 + std::sqrt(5.0)) * i;
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// From the lowest to the highest of the points along `axis`.
struct Extent {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double length() const { return high - low; }
};
Extent span_along(std::span<const Vec3f> points, const Vec3d& axis) {
  Extent span{1e300, -1e300};
  for (const Vec3f& point : points) {
    const double at = point.cast<double>().dot(axis);
    span.low = std::min(span.low, at);
    span.high = std::max(span.high, at);
  }
  return span;
}

/// One axis of a perspective view: a point at (offset across, depth along) is seen from an eye at
/// (across, along) where |offset - across| <= slope (depth - along).
struct Wedge {
  double above = -1e300, below = -1e300;  // the greatest of +-offset - slope * depth
  double slope = 1;

  void add(double offset, double depth) {
    above = std::max(above, offset - slope * depth);
    below = std::max(below, -offset - slope * depth);
  }
  /// The last place along the view from which all is in, and there the middle.
  double along() const { return -(above + below) / (2 * slope); }
  double across() const { return (above - below) / 2; }
};

}  // namespace

std::vector<Vec3f> reach_of(std::span<const Vec3f> points, double outliers) {
  constexpr int kDirections = 96;
  constexpr std::size_t kEnough = 8000;  // points to go by
  std::vector<Vec3f> some;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kEnough);
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  std::vector<Vec3f> reach;
  if (some.empty()) return reach;
  const auto left_out = static_cast<std::size_t>(outliers * static_cast<double>(some.size()));
  const auto last = static_cast<std::ptrdiff_t>(some.size() - 1 - left_out);
  for (int i = 0; i < kDirections; ++i) {
    const Vec3f along = direction(i, kDirections).cast<float>();
    std::nth_element(some.begin(), some.begin() + last, some.end(),
                     [&](const Vec3f& a, const Vec3f& b) { return a.dot(along) < b.dot(along); });
    reach.push_back(some[static_cast<std::size_t>(last)]);
  }
  return reach;
}

std::vector<Vec3f> bulk_of(std::span<const Vec3f> points, double cell_m) {
  using Cell = std::array<int, 3>;
  constexpr double kFar = 1e9;  // cells
  std::map<Cell, std::uint32_t> cells;
  std::vector<std::uint32_t> cell_of;
  std::vector<std::size_t> points_in;
  for (const Vec3f& point : points) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] =
          static_cast<int>(std::clamp(std::floor(point[axis] / cell_m), -kFar, kFar));
    const auto at = cells.emplace(cell, static_cast<std::uint32_t>(cells.size())).first->second;
    if (at == points_in.size()) points_in.push_back(0);
    ++points_in[at];
    cell_of.push_back(at);
  }
  DisjointSets pieces(cells.size());
  for (const auto& [cell, index] : cells)
    for (int step = 0; step < 27; ++step) {
      const Cell beside = {cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1,
                           cell[2] + step / 9 - 1};
      if (const auto other = cells.find(beside); other != cells.end())
        pieces.join(index, other->second);
    }
  std::vector<std::size_t> piece_size(cells.size(), 0);
  for (std::uint32_t i = 0; i < points_in.size(); ++i) piece_size[pieces.root(i)] += points_in[i];
  std::vector<Vec3f> bulk;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (50 * piece_size[pieces.root(cell_of[i])] >= points.size()) bulk.push_back(points[i]);
  return bulk;
}

Camera camera_holding(std::span<const Vec3f> reach, const Lens& lens) {
  Camera camera;
  camera.fov_y_deg = lens.fov_y_deg;
  camera.up = lens.up;
  Vec3d right = lens.forward.cross(lens.up);
  right = right.norm() > 1e-9 ? Vec3d(right.normalized()) : Vec3d(lens.forward.unitOrthogonal());
  const Vec3d upwards = right.cross(lens.forward);
  const double slope = std::tan(lens.fov_y_deg * kRadPerDeg / 2);
  constexpr double kNearest_m = 0.05;
  double across = 0, height = 0, target = 0, distance = 2;
  if (!reach.empty()) {
    const Extent x = span_along(reach, right), y = span_along(reach, upwards);
    const Extent z = span_along(reach, lens.forward);
    target = z.middle();
    if (lens.orthographic) {
      across = x.middle();
      height = y.middle();
      distance = std::max(x.length() / lens.aspect, y.length()) / (2 * kMargin * slope);
    } else {
      Wedge wide{.slope = kMargin * slope * lens.aspect}, high{.slope = kMargin * slope};
      for (const Vec3f& point : reach) {
        const Vec3d p = point.cast<double>();
        wide.add(p.dot(right), p.dot(lens.forward));
        high.add(p.dot(upwards), p.dot(lens.forward));
      }
      across = wide.across();
      height = high.across();
      distance = target - std::min(wide.along(), high.along());
    }
    distance = std::max(kNearest_m, lens.room * distance);
  }
  camera.target = across * right + height * upwards + target * lens.forward;
  camera.eye = camera.target - distance * lens.forward;
  camera.near_m = std::max(0.005, 0.02 * distance);
  camera.far_m = std::max(200.0, 20 * distance);
  return camera;
}

}  // namespace planescope::render
