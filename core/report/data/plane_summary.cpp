#include "core/report/data/plane_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/model/plane.hpp"

namespace planescope::report {
namespace {

// Number of distinct cells of edge `cell_m` that hold a point.
std::size_t occupied_cells(const std::vector<Vec2d>& points, double cell_m) {
  std::vector<std::pair<std::int64_t, std::int64_t>> cells;
  cells.reserve(points.size());
  for (const Vec2d& p : points)
    cells.emplace_back(std::llround(std::floor(p.x() / cell_m)),
                       std::llround(std::floor(p.y() / cell_m)));
  std::sort(cells.begin(), cells.end());
  return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

}  // namespace

std::vector<PlaneSummary> summarize_planes(const planes::FrameResult& result, double voxel_size_m) {
  const std::size_t n = result.segmentation.planes.size();
  std::vector<std::vector<std::uint32_t>> members(n);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (result.plane_of[i] > 0)
      members[static_cast<std::size_t>(result.plane_of[i]) - 1].push_back(
          static_cast<std::uint32_t>(i));

  const double cell_m = voxel_size_m > 0 ? voxel_size_m : 0.02;
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
    s.area_m2 = static_cast<double>(occupied_cells(flat, cell_m)) * cell_m * cell_m;
    for (const Vec2d& corner : convex_hull(std::move(flat)))
      s.hull.push_back(s.centroid + corner.x() * basis.u + corner.y() * basis.v);
  }
  return summaries;
}

}  // namespace planescope::report
