// The hull is that of few points: those inside one of the extremes of each column of cells are left
// out before anything is sorted.

#include "core/report/data/plane_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/model/plane.hpp"

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

  /// Of a point: its cell, from 0.
  int at(double x) const {  // std::floor() is a call where SSE 4.1 is not
    const double cells_from_0 = x / cell_m;
    const auto cut = static_cast<int>(cells_from_0);
    return cut - (static_cast<double>(cut) > cells_from_0) - first;
  }
  double begin_of(int cell) const { return (cell + first) * cell_m; }
};

struct Range {
  double least = kInfinity, greatest = -kInfinity;
  void add(double x) { least = std::min(least, x), greatest = std::max(greatest, x); }
};

/// Without cells where a point would be too far from 0 for an int.
Axis axis_of(const std::vector<double>& places, double cell_m) {
  constexpr double kFarthest = 1 << 30;
  Range range;
  for (const double x : places) range.add(x);
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
    for (int c = std::max(0, columns.at(left)); c <= columns.cells; ++c) {
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

  Cover cover;
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(cells));
  std::vector<int> column_of(points.size());
  struct Extremes {
    Range v;
    double u_of_least = 0, u_of_greatest = 0;
  };
  std::vector<Extremes> extremes(columns.cells);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i], v = points.v[i];
    const int column = column_of[i] = columns.at(u);
    std::uint8_t& cell =
        occupied[static_cast<std::size_t>(rows.at(v)) * columns.cells + column];
    cover.cells += cell == 0;
    cell = 1;
    Extremes& e = extremes[column];
    if (v < e.v.least) e.v.least = v, e.u_of_least = u;
    if (v > e.v.greatest) e.v.greatest = v, e.u_of_greatest = u;
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
