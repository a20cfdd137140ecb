// The hull is that of few points: those inside one of the extremes of each column of cells are left
// out before anything is sorted.

#include "core/report/data/plane_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/model/plane.hpp"
#include "core/planes/cloud/pixel_kernels.hpp"

namespace planescope::report {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cell_at(double at, double cell_m) { return std::floor(at / cell_m); }

/// Few points in a wide grid.
Cover cover_of_sparse(const FlatPoints& points, double cell_m) {
  std::vector<std::array<double, 2>> cells;
  std::vector<Vec2d> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    cells.push_back({cell_at(points.u[i], cell_m), cell_at(points.v[i], cell_m)});
    all.push_back(points[i]);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return {cells.size(), convex_hull(std::move(all))};
}

/// Along an axis of the grid.
struct Axis {
  int first = 0;  // cell
  int cells = 0;
  double cell_m = 0;

  double begin_of(int cell) const { return (cell + first) * cell_m; }
  /// The first cell, from 0, that does not begin before `place`.
  int from(double place) const {
    return std::max(0, static_cast<int>(cell_at(place, cell_m)) - first);
  }
  std::vector<std::int32_t> cells_of(const std::vector<double>& places) const {
    std::vector<std::int32_t> result(places.size());
    planes::pixel_kernels(best_simd())
        .find_cells({.count = places.size(),
                     .places = places.data(),
                     .cell = cell_m,
                     .first = first,
                     .cells = result.data()});
    return result;
  }
};

struct Range {
  double least = kInfinity, greatest = -kInfinity;
  void add(double x) { least = std::min(least, x), greatest = std::max(greatest, x); }
};

/// Four at a time, none of which waits for another.
Range range_of(const std::vector<double>& places) {
  Range lanes[4];
  std::size_t i = 0;
  for (; i + 4 <= places.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) lanes[k].add(places[i + k]);
  for (; i < places.size(); ++i) lanes[0].add(places[i]);
  for (const Range& lane : lanes) lanes[0].add(lane.least), lanes[0].add(lane.greatest);
  return lanes[0];
}

/// Without cells where a point would be too far from 0 for an int.
Axis axis_of(const std::vector<double>& places, double cell_m) {
  constexpr double kFarthest = 1 << 30;
  const Range range = range_of(places);
  const double first = cell_at(range.least, cell_m), last = cell_at(range.greatest, cell_m);
  if (!(first > -kFarthest && last < kFarthest)) return {0, 0, cell_m};
  return {static_cast<int>(first), static_cast<int>(last - first) + 1, cell_m};
}

std::size_t occupied_cells(const std::vector<std::int32_t>& column_of,
                           const std::vector<std::int32_t>& row_of,
                           int columns,
                           int rows) {
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(columns) * rows);
  const std::int32_t *const column = column_of.data(), *const row = row_of.data();
  std::uint8_t* const cell = occupied.data();
  for (std::size_t i = 0, count = column_of.size(); i < count; ++i)
    cell[static_cast<std::size_t>(row[i]) * columns + column[i]] = 1;
  return static_cast<std::size_t>(std::ranges::count(occupied, 1));
}

/// Of each column, what is inside the hull of some of the points: least < v < greatest.
std::vector<Range> inside_of(const std::vector<Vec2d>& hull, const Axis& columns) {
  std::vector<double> lower(columns.cells + 1, kInfinity), upper(columns.cells + 1, -kInfinity);
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const auto [left, right] = std::minmax(a.x(), b.x());
    if (!(left < right)) continue;
    for (int c = columns.from(left); c <= columns.cells; ++c) {
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

}  // namespace

Cover cover_of(const FlatPoints& points, double cell_m) {
  if (points.size() == 0) return {};
  const Axis columns = axis_of(points.u, cell_m), rows = axis_of(points.v, cell_m);
  const double cells = static_cast<double>(columns.cells) * rows.cells;
  if (cells == 0 || cells > 4096 + 8 * static_cast<double>(points.size()))
    return cover_of_sparse(points, cell_m);

  const std::vector<std::int32_t> column_of = columns.cells_of(points.u);
  const std::vector<std::int32_t> row_of = rows.cells_of(points.v);
  Cover cover;
  cover.cells = occupied_cells(column_of, row_of, columns.cells, rows.cells);
  struct Extremes {
    Range v;
    double u_of_least = 0, u_of_greatest = 0;
  };
  std::vector<Extremes> extremes(columns.cells);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Extremes& e = extremes[column_of[i]];
    const double v = points.v[i];
    if (v < e.v.least) e.v.least = v, e.u_of_least = points.u[i];
    if (v > e.v.greatest) e.v.greatest = v, e.u_of_greatest = points.u[i];
  }
  std::vector<Vec2d> some;
  for (const Extremes& e : extremes)
    if (e.v.least <= e.v.greatest)
      some.insert(some.end(), {{e.u_of_least, e.v.least}, {e.u_of_greatest, e.v.greatest}});
  const std::vector<Range> inside = inside_of(convex_hull(std::move(some)), columns);
  std::vector<Vec2d> outside;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Range& range = inside[column_of[i]];
    if (!(points.v[i] > range.least && points.v[i] < range.greatest)) outside.push_back(points[i]);
  }
  cover.hull = convex_hull(std::move(outside));
  return cover;
}

}  // namespace planescope::report
