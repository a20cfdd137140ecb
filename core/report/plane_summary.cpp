#include "core/report/plane_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/hull.hpp"

namespace planescope {
namespace {

constexpr double kAreaCell = 0.02;  // [m]

double covered_area(std::span<const Vec2d> points) {
  std::vector<std::int64_t> cells;
  cells.reserve(points.size());
  for (const Vec2d& p : points) {
    const auto column = static_cast<std::int64_t>(std::floor(p.x() / kAreaCell));
    const auto row = static_cast<std::int64_t>(std::floor(p.y() / kAreaCell));
    cells.push_back(column * (std::int64_t{1} << 32) + row);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return static_cast<double>(cells.size()) * kAreaCell * kAreaCell;
}

PlaneSummary summarize(const PlaneRegion& plane,
                       std::span<const Vec3f> points,
                       std::span<const std::uint32_t> members,
                       const Vec3d& origin) {
  PlaneSummary summary;
  summary.id = plane.id;
  summary.label = plane.label;
  summary.normal = plane.fit.normal;
  summary.centroid = plane.fit.centroid + origin;
  summary.offset_m = summary.normal.dot(summary.centroid);
  const double up = std::min(1.0, std::abs(summary.normal.z()));
  summary.tilt_deg = std::acos(up) * 180 / std::numbers::pi;
  summary.rms_m = plane.fit.rms_m();
  summary.points = static_cast<std::uint32_t>(members.size());
  summary.voxels = plane.points;

  const PlaneBasis basis = plane_basis(plane.fit.normal);
  std::vector<Vec2d> flat;
  flat.reserve(members.size());
  for (const std::uint32_t i : members) {
    const Vec3d d = points[i].cast<double>() - plane.fit.centroid;
    flat.emplace_back(d.dot(basis.u), d.dot(basis.v));
  }
  summary.area_m2 = covered_area(flat);
  for (const Vec2d& p : convex_hull(std::move(flat)))
    summary.hull.push_back(summary.centroid + p.x() * basis.u + p.y() * basis.v);
  return summary;
}

}  // namespace

std::vector<PlaneSummary> summarize_planes(std::span<const PlaneRegion> planes,
                                           std::span<const Vec3f> points,
                                           std::span<const std::int32_t> plane_of,
                                           const Vec3d& origin) {
  std::vector<std::vector<std::uint32_t>> members(planes.size());
  for (std::size_t i = 0; i < plane_of.size(); ++i)
    if (plane_of[i] > 0) members[plane_of[i] - 1].push_back(static_cast<std::uint32_t>(i));
  std::vector<PlaneSummary> summaries;
  summaries.reserve(planes.size());
  for (std::size_t p = 0; p < planes.size(); ++p)
    summaries.push_back(summarize(planes[p], points, members[p], origin));
  return summaries;
}

std::vector<PlaneSummary> summarize_planes(const FrameResult& result) {
  return summarize_planes(result.segmentation.planes, result.cloud.points, result.plane_of,
                          result.cloud.origin);
}

}  // namespace planescope
