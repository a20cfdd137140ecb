// Runs all methods on one frame, including an oracle that knows the true planes.

#include "core/lab/experiments/contest.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/lab/rivals/rivals.hpp"

namespace planescope::lab {

planes::SourceTruth truth_of(const EvaluationFrame& frame) {
  planes::SourceTruth truth = frame.labels ? planes::truth_of_labels(*frame.labels)
                                           : *planes::truth_of_cloud(*frame.frame.cloud);
  if (!frame.normals.empty()) truth.normals = frame.normals;  // exact normals if they are known
  return truth;
}

Contest::Contest(const Frame& frame,
                 const Labellers& labellers,
                 const planes::SourceTruth* truth,
                 std::optional<double> max_range_m)
    : frame_(frame), labellers_(labellers), max_range_m_(max_range_m) {
  if (truth) on_points_ = planes::truth_on_points(truth->values, planes::measured_sources(frame));
}

planes::FrameResult Contest::run(const CellKey& key) {
  const planes::PipelineOptions options = this->options(key);
  if (options.method != planes::Method::ours)
    return run_method(frame_, options, nullptr, find_library_rival(key.method));
  planes::FrameResult result{prepared(key.classifier, key), {}, {}};
  planes::FoundRegions found = planes::find_regions(frame_, result, options);
  result.segmentation = std::move(found.segmentation);
  result.plane_of = std::move(found.plane_of);
  return result;
}

const planes::PreparedFrame& Contest::prepared(const std::string& labels, const CellKey& key) {
  const planes::PipelineOptions of_labels = options(with_ours(key, key.profile, labels));
  const auto [at, is_new] =
      prepared_.try_emplace({labels, planes::is_found_on_pixels(frame_, of_labels)});
  if (!is_new) return at->second;
  const planes::Classifier* classifier =  // without labels: any classifier, it is not used
      labels == "gcn"   ? labellers_.gcn.get()
      : labels == "pca" ? labellers_.pca.get()
                        : nullptr;
  at->second = planes::prepare_frame(frame_, of_labels, classifier, &on_points_);
  return at->second;
}

planes::PipelineOptions Contest::options(const CellKey& key) const {
  planes::PipelineOptions options = cell_options(key);
  if (max_range_m_) options.cloud.max_range_m = *max_range_m_;
  return options;
}

// ---- The oracle ----

namespace {

struct HalfSpace {
  Vec3d normal;  // unit; inside: normal . x >= offset
  double offset = 0;
  double at(const Vec3d& p) const { return normal.dot(p) - offset; }
};

/// A polygon as its plane and the half-spaces of its edges.
struct Region {
  std::span<const Vec3d> corners;
  HalfSpace plane;
  std::vector<HalfSpace> edges;
};

Region region_of(const TruePolygon& polygon) {
  assert(polygon.corners.size() >= 3);
  Region region{polygon.corners, {Vec3d::Zero()}, {}};
  const std::vector<Vec3d>& corners = polygon.corners;
  const auto after = [&](std::size_t i) { return corners[(i + 1) % corners.size()]; };
  // Newell: twice the area, even if some corners are in line.
  for (std::size_t i = 0; i < corners.size(); ++i)
    region.plane.normal += (corners[i] - corners[0]).cross(after(i) - corners[0]);
  region.plane.normal.normalize();
  region.plane.offset = region.plane.normal.dot(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d inward = region.plane.normal.cross(after(i) - corners[i]).normalized();
    region.edges.push_back({inward, inward.dot(corners[i])});
  }
  return region;
}

double distance_to_segment(const Vec3d& a, const Vec3d& b, const Vec3d& point) {
  const Vec3d along = b - a;
  const double t = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (point - a - t * along).norm();
}

double distance_to(const Region& region, const Vec3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    if (region.edges[i].at(point) >= 0) continue;
    const Vec3d& b = region.corners[(i + 1) % region.corners.size()];
    nearest = std::min(nearest, distance_to_segment(region.corners[i], b, point));
  }
  return std::isinf(nearest) ? std::abs(region.plane.at(point)) : nearest;
}

}  // namespace

double distance_m(const TruePolygon& polygon, const Vec3d& point) {
  return distance_to(region_of(polygon), point);
}

std::vector<std::int32_t> oracle_planes(std::span<const Vec3f> points,
                                        std::span<const TruePolygon> polygons) {
  std::vector<Region> regions;
  for (const TruePolygon& polygon : polygons) regions.push_back(region_of(polygon));
  std::vector<std::int32_t> planes;
  planes.reserve(points.size());
  for (const Vec3f& p : points) {
    const Vec3d point = p.cast<double>();
    double nearest = std::numeric_limits<double>::infinity();
    int plane = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      if (std::abs(regions[i].plane.at(point)) >= nearest) continue;  // no part of it is nearer
      const double distance = distance_to(regions[i], point);
      if (distance >= nearest) continue;
      nearest = distance;
      plane = polygons[i].plane;
    }
    planes.push_back(plane);
  }
  return planes;
}

planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons) {
  std::vector<TruePolygon> in_cloud(polygons.begin(), polygons.end());
  for (TruePolygon& polygon : in_cloud)
    for (Vec3d& corner : polygon.corners)
      corner = prepared.cloud.T_world_sensor * corner - prepared.cloud.origin;

  planes::FrameResult result{prepared, {}, {}};
  planes::Segmentation& found = result.segmentation;
  const std::vector<Vec3f>& points = prepared.voxels.points;
  found.plane_of = oracle_planes(points, in_cloud);
  const int planes =
      found.plane_of.empty() ? 0 : std::max(0, *std::ranges::max_element(found.plane_of));
  std::vector<Moments> moments(static_cast<std::size_t>(planes));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (found.plane_of[i] > 0)
      moments[static_cast<std::size_t>(found.plane_of[i]) - 1].add(points[i].cast<double>());
  for (int id = 1; id <= planes; ++id) {
    planes::PlaneRegion& plane = found.planes.emplace_back();
    plane.id = id;
    plane.fit = fit_plane(moments[static_cast<std::size_t>(id) - 1]);
    plane.points = static_cast<std::uint32_t>(plane.fit.count);
  }
  for (const std::uint32_t voxel : prepared.voxels.voxel_of)
    result.plane_of.push_back(voxel == planes::kNoVoxel ? 0 : found.plane_of[voxel]);
  return result;
}

}  // namespace planescope::lab
