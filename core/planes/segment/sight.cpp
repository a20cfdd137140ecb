#include "core/planes/segment/sight.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::planes {
namespace {

constexpr double kMaxCells = 1000;  // along an axis: a bound on memory

}  // namespace

Sight::Sight(const SegmentState& state, std::int32_t plane, double spacing_m)
    : state_(state), options_(state.options.split_disconnected), fit_(state.planes[plane].fit) {
  u_ = fit_.normal.unitOrthogonal();
  v_ = fit_.normal.cross(u_);
  low_ = Vec2d::Constant(INFINITY);
  Vec2d high = -low_;
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i) {
    if (state.plane_of[i] != plane) continue;
    const Vec2d p = on_plane(state.point(i));
    low_ = low_.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec2d size = high - low_;
  cell_m_ = std::max({options_.sight_cell_m, spacing_m, size.maxCoeff() / kMaxCells});
  columns_ = static_cast<int>(size.x() / cell_m_) + 1;
  rows_ = static_cast<int>(size.y() / cell_m_) + 1;
  passed_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] != plane) mark(state.point(i));
  for (const Vec3f& p : state.more.beyond) mark(p.cast<double>());
}

std::optional<Vec3d> Sight::passed_at(const Vec3d& measured) const {
  const double point_m = fit_.distance_m(measured);
  if (std::abs(point_m) < std::max(options_.behind_m, options_.behind_taus * state_.tau(measured)))
    return std::nullopt;
  const double sensor_m = fit_.distance_m(state_.sensor);
  if (sensor_m * point_m >= 0) return std::nullopt;  // before the plane
  return state_.sensor + sensor_m / (sensor_m - point_m) * (measured - state_.sensor);
}

void Sight::mark(const Vec3d& measured) {
  const std::optional<Vec3d> passed = passed_at(measured);
  if (!passed) return;
  const Vec2d at = (on_plane(*passed) - low_) / cell_m_;
  if (at.x() < 0 || at.y() < 0 || at.x() >= columns_ || at.y() >= rows_) return;
  passed_[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(columns_) +
          static_cast<std::size_t>(at.x())] = 1;
}

bool Sight::is_open_at(const Vec3d& p) const {
  // Rays are about a cell apart.
  const Vec2d at = (on_plane(p) - low_) / cell_m_;
  const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
  for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
    for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
      if (passed_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(c)])
        return true;
  return false;
}

bool Sight::is_open_between(std::span<const std::uint32_t> a,
                            std::span<const std::uint32_t> b) const {
  const std::vector<Vec3f>& points = state_.octree.points;
  // From the point of b nearest to a's first, back and forth: not the very nearest pair, but one
  // that faces each other.
  std::uint32_t from = a[0], to = b[0];
  const auto nearest = [&](std::span<const std::uint32_t> part, std::uint32_t point) {
    return *std::min_element(part.begin(), part.end(), [&](std::uint32_t i, std::uint32_t j) {
      return (points[i] - points[point]).squaredNorm() < (points[j] - points[point]).squaredNorm();
    });
  };
  for (bool changed = true; changed;) {
    const std::uint32_t next_to = nearest(b, from), next_from = nearest(a, next_to);
    changed = next_to != to || next_from != from;
    to = next_to, from = next_from;
  }
  const Vec3d start = points[from].cast<double>(), gap = points[to].cast<double>() - start;
  const int samples = static_cast<int>(gap.norm() / cell_m_) - 1;
  int open = 0;
  for (int k = 1; k <= samples; ++k) open += is_open_at(start + gap * k / (samples + 1)) ? 1 : 0;
  return samples > 0 && open >= options_.open_share * samples;
}

}  // namespace planescope::planes
