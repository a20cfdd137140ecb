#include "core/report/data/plane_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/model/plane.hpp"

namespace planescope::report {
namespace {

constexpr int kMostRegionSamples = 8192;

/// What a grid on the plane tells of points.
struct Cover {
  std::size_t cells = 0;   // that hold a point
  std::vector<Vec2d> rim;  // all corners of the convex hull are among these points
};

std::int64_t cell_at(double at, double cell_m) {
  const double cells = at / cell_m;
  const auto cut = static_cast<std::int64_t>(cells);
  return cut - (static_cast<double>(cut) > cells);  // std::floor() is a call where SSE 4.1 is not
}

/// Few points in a wide grid.
Cover cover_of_sparse(std::vector<std::array<std::int64_t, 2>> cells, std::vector<Vec2d> points) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return {cells.size(), std::move(points)};
}

Cover cover_of(std::vector<Vec2d> points, double cell_m) {
  if (points.empty()) return {};
  std::vector<std::array<std::int64_t, 2>> cells(points.size());
  std::array<std::int64_t, 2> low, high;
  low.fill(std::numeric_limits<std::int64_t>::max());
  high.fill(std::numeric_limits<std::int64_t>::min());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) {
      const std::int64_t at = cells[i][axis] = cell_at(points[i][axis], cell_m);
      low[axis] = std::min(low[axis], at);
      high[axis] = std::max(high[axis], at);
    }
  const double columns = static_cast<double>(high[0]) - static_cast<double>(low[0]) + 1;
  const double rows = static_cast<double>(high[1]) - static_cast<double>(low[1]) + 1;
  if (columns * rows > 4096 + 8 * static_cast<double>(points.size()))
    return cover_of_sparse(std::move(cells), std::move(points));

  struct Span {
    int first = std::numeric_limits<int>::max(), last = -1;
    void add(int at) { first = std::min(first, at), last = std::max(last, at); }
    /// Something lies two or more before it, and behind it.
    bool is_deep(int at) const { return at >= first + 2 && at <= last - 2; }
  };
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(columns * rows));
  std::vector<Span> of_row(static_cast<std::size_t>(rows));
  std::vector<Span> of_column(static_cast<std::size_t>(columns));
  Cover cover;
  const auto place = [&](std::size_t i) {
    return std::pair(static_cast<int>(cells[i][0] - low[0]),
                     static_cast<int>(cells[i][1] - low[1]));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [column, row] = place(i);
    std::uint8_t& cell = occupied[row * of_column.size() + column];
    if (cell) continue;
    cell = 1;
    ++cover.cells;
    of_row[row].add(column);
    of_column[column].add(row);
  }
  // A line with all points on one side of it passes no cell that has others in its row and its
  // column two or more away on all four sides: whatever its slope, one of the four is beyond.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [column, row] = place(i);
    if (!of_row[row].is_deep(column) || !of_column[column].is_deep(row))
      cover.rim.push_back(points[i]);
  }
  return cover;
}

}  // namespace

std::vector<PlaneSummary> summarize_planes(const planes::FrameResult& result, double voxel_size_m) {
  const std::size_t n = result.segmentation.planes.size();
  std::vector<std::vector<std::uint32_t>> members(n);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (result.plane_of[i] > 0)
      members[static_cast<std::size_t>(result.plane_of[i]) - 1].push_back(
          static_cast<std::uint32_t>(i));

  const double cell_m = cell_size_m(voxel_size_m);
  std::vector<PlaneSummary> summaries(n);
  for (std::size_t k = 0; k < n; ++k) {
    const planes::PlaneRegion& plane = result.segmentation.planes[k];
    PlaneSummary& s = summaries[k];
    s.id = plane.id;
    s.label = plane.label;
    s.normal = plane.fit.normal;
    s.centroid = result.cloud.origin + plane.fit.centroid;
    s.offset_m = s.normal.dot(s.centroid);
    s.tilt_deg = result.gravity.known()
                     ? std::acos(std::min(1.0, std::abs(s.normal.z()))) * 180 / std::numbers::pi
                     : std::nan("");
    s.points = members[k].size();
    s.voxels = plane.points;

    const PlaneBasis basis = plane_basis(s.normal);
    std::vector<Vec2d> flat;
    flat.reserve(members[k].size());
    double squares = 0;
    for (const std::uint32_t i : members[k]) {
      const Vec3d d = result.cloud.points[i].cast<double>() - plane.fit.centroid;
      flat.emplace_back(basis.u.dot(d), basis.v.dot(d));
      const double distance = s.normal.dot(d);
      squares += distance * distance;
    }
    if (!flat.empty()) s.rms_m = std::sqrt(squares / static_cast<double>(flat.size()));
    Cover cover = cover_of(std::move(flat), cell_m);
    s.area_m2 = static_cast<double>(cover.cells) * cell_m * cell_m;
    for (const Vec2d& corner : convex_hull(std::move(cover.rim)))
      s.hull.push_back(s.centroid + corner.x() * basis.u + corner.y() * basis.v);
  }
  return summaries;
}

std::vector<int> RegionSample::plane_of() const {
  std::vector<int> result;
  for (const Run& run : runs)
    result.insert(result.end(), static_cast<std::size_t>(run.count), run.plane);
  return result;
}

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of) {
  std::vector<RegionSample::Run> runs;
  for (const int plane : plane_of) {
    if (runs.empty() || runs.back().plane != plane) runs.push_back({plane, 0});
    ++runs.back().count;
  }
  return runs;
}

RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result) {
  const planes::Cloud& cloud = result.cloud;
  const int width =
      frame.is_cloud() ? static_cast<int>(frame.cloud->points.size()) : frame.depth.width;
  const int height = frame.is_cloud() ? 1 : frame.depth.height;
  RegionSample sample;
  const auto measure = [&] {
    sample.columns = (width + sample.step - 1) / sample.step;
    sample.rows = (height + sample.step - 1) / sample.step;
  };
  for (measure(); std::int64_t{sample.columns} * sample.rows > kMostRegionSamples; measure())
    sample.step *= 2;
  std::vector<int> plane_of(static_cast<std::size_t>(sample.columns) * sample.rows, -1);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    const int u = static_cast<int>(cloud.source[i] % width);
    const int v = static_cast<int>(cloud.source[i] / width);
    if (u % sample.step == 0 && v % sample.step == 0)
      plane_of[static_cast<std::size_t>(v / sample.step) * sample.columns + u / sample.step] =
          result.plane_of[i];
  }
  sample.runs = runs_of(plane_of);
  return sample;
}

}  // namespace planescope::report
