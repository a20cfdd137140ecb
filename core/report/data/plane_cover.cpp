// The hull is that of few points: those inside one of the extremes of each column of cells are left
// out before anything is sorted.

#include "core/report/data/plane_cover.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace planescope::report {

using Block = FlatPoints::Block;

FlatPoints::FlatPoints(const std::vector<Vec3f>& points,
                       std::span<const planes::PointRun> runs,
                       const PlaneBasis& basis,
                       const Vec3d& normal,
                       const Vec3d& origin)
    : points_(points), runs_(runs), kernels_(planes::pixel_kernels(best_simd())) {
  for (const planes::PointRun& run : runs) size_ += run.end - run.begin;
  for (int axis = 0; axis < 3; ++axis) {
    args_.origin[axis] = origin[axis];
    args_.u_axis[axis] = basis.u[axis], args_.v_axis[axis] = basis.v[axis];
    args_.n_axis[axis] = normal[axis];
  }
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cell_at(double at, double cell_m) { return std::floor(at / cell_m); }

struct Range {
  double least = kInfinity, greatest = -kInfinity;
  void add(double x) { least = std::min(least, x), greatest = std::max(greatest, x); }
};

/// What is known after a first look at all points.
struct Bounds2 {
  Range u, v;
  double squares_m2 = 0;
};

Bounds2 bounds_of(const FlatPoints& points) {
  Bounds2 bounds;
  points.visit([&](const Block& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
      bounds.u.add(block.u[i]);
      bounds.v.add(block.v[i]);
      bounds.squares_m2 += block.n[i] * block.n[i];
    }
  });
  return bounds;
}

/// Few points in a wide grid.
void cover_sparse(const FlatPoints& points, double cell_m, Cover& cover) {
  std::vector<std::array<double, 2>> cells;
  std::vector<Vec2d> all;
  points.visit([&](const Block& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
      cells.push_back({cell_at(block.u[i], cell_m), cell_at(block.v[i], cell_m)});
      all.emplace_back(block.u[i], block.v[i]);
    }
  });
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  cover.cells = cells.size();
  cover.hull = convex_hull(std::move(all));
}

/// Along an axis of the grid.
struct Axis {
  int first = 0;  // cell
  int cells = 0;
  double cell_m = 0;

  double begin_of(int cell) const { return (cell + first) * cell_m; }
  /// The cell, from 0, in which `place` is, or the first one.
  int at(double place) const {
    return std::max(0, static_cast<int>(cell_at(place, cell_m)) - first);
  }
  void find_cells(const double* places, std::size_t count, std::int32_t* to) const {
    planes::pixel_kernels(best_simd())
        .find_cells(
            {.count = count, .places = places, .cell = cell_m, .first = first, .cells = to});
  }
};

/// Without cells where a point would be too far from 0 for an int.
Axis axis_of(const Range& range, double cell_m) {
  constexpr double kFarthest = 1 << 30;
  const double first = cell_at(range.least, cell_m), last = cell_at(range.greatest, cell_m);
  if (!(first > -kFarthest && last < kFarthest)) return {0, 0, cell_m};
  return {static_cast<int>(first), static_cast<int>(last - first) + 1, cell_m};
}

/// Of each column, what is inside the hull of some of the points: least < v < greatest.
std::vector<Range> inside_of(const std::vector<Vec2d>& hull, const Axis& columns) {
  std::vector<double> lower(columns.cells + 1, kInfinity), upper(columns.cells + 1, -kInfinity);
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const auto [left, right] = std::minmax(a.x(), b.x());
    if (!(left < right)) continue;
    for (int c = columns.at(left); c <= columns.cells; ++c) {
      const double x = columns.begin_of(c);
      if (x > right) break;
      if (x < left) continue;
      const double y = a.y() + (x - a.x()) * (b.y() - a.y()) / (b.x() - a.x());
      (a.x() < b.x() ? lower : upper)[c] = y;
    }
  }
  // Beyond any rounding, and what is left out changes nothing when corners are chosen.
  const double margin_m = columns.cell_m / 8;
  std::vector<Range> inside(columns.cells);
  for (int c = 0; c < columns.cells; ++c)
    inside[c] = {std::max(lower[c], lower[c + 1]) + margin_m,
                 std::min(upper[c], upper[c + 1]) - margin_m};
  return inside;
}

/// Of a column: its points with the least and the greatest v.
struct Extremes {
  Vec2d lowest{0, kInfinity}, highest{0, -kInfinity};

  void add(double u, double v) {
    if (v < lowest.y()) lowest = {u, v};
    if (v > highest.y()) highest = {u, v};
  }
};

/// Fills in how many cells are occupied. By column.
std::vector<Extremes> look_at_cells(const FlatPoints& points,
                                    const Axis& columns,
                                    const Axis& rows,
                                    Cover& cover) {
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(columns.cells) * rows.cells);
  std::vector<Extremes> extremes(columns.cells);
  points.visit([&, cell = occupied.data()](const Block& block) {
    std::int32_t column[FlatPoints::kMost], row[FlatPoints::kMost];
    columns.find_cells(block.u, block.count, column);
    rows.find_cells(block.v, block.count, row);
    for (std::size_t i = 0; i < block.count; ++i)
      cell[static_cast<std::size_t>(row[i]) * columns.cells + column[i]] = 1;
    for (std::size_t i = 0; i < block.count; ++i) extremes[column[i]].add(block.u[i], block.v[i]);
  });
  cover.cells = static_cast<std::size_t>(std::ranges::count(occupied, 1));
  return extremes;
}

}  // namespace

Cover cover_of(const FlatPoints& points, double cell_m) {
  Cover cover;
  if (points.size() == 0) return cover;
  const Bounds2 bounds = bounds_of(points);
  cover.squares_m2 = bounds.squares_m2;
  const Axis columns = axis_of(bounds.u, cell_m), rows = axis_of(bounds.v, cell_m);
  const double cells = static_cast<double>(columns.cells) * rows.cells;
  if (cells == 0 || cells > 4096 + 8 * static_cast<double>(points.size())) {
    cover_sparse(points, cell_m, cover);
    return cover;
  }
  std::vector<Vec2d> some;
  for (const Extremes& e : look_at_cells(points, columns, rows, cover))
    if (e.lowest.y() <= e.highest.y()) some.insert(some.end(), {e.lowest, e.highest});
  const std::vector<Range> inside = inside_of(convex_hull(std::move(some)), columns);
  std::vector<Vec2d> outside;
  points.visit([&](const Block& block) {
    std::int32_t column[FlatPoints::kMost];
    columns.find_cells(block.u, block.count, column);
    for (std::size_t i = 0; i < block.count; ++i) {
      const Range& range = inside[column[i]];
      if (!(block.v[i] > range.least && block.v[i] < range.greatest))
        outside.emplace_back(block.u[i], block.v[i]);
    }
  });
  cover.hull = convex_hull(std::move(outside));
  return cover;
}

}  // namespace planescope::report
