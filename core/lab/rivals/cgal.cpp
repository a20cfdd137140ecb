// Rival methods from CGAL 5.5. Its shape detection and normal estimation are under the GPL.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Random.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing_on_point_set.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>

#include "core/lab/rivals/rivals.hpp"

namespace planescope::lab {
namespace {

namespace detection = CGAL::Shape_detection;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct OrientedPoint {
  Kernel::Point_3 point;
  Kernel::Vector_3 normal;
  std::size_t index = 0;  // original index: CGAL reorders points
};
using OrientedPoints = std::vector<OrientedPoint>;

template <typename Value, Value OrientedPoint::*member>
struct MemberMap {
  using key_type = OrientedPoint;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::lvalue_property_map_tag;
  friend reference get(MemberMap, const OrientedPoint& p) { return p.*member; }
  friend void put(MemberMap, OrientedPoint& p, const Value& value) { p.*member = value; }
};
using PointMap = MemberMap<Kernel::Point_3, &OrientedPoint::point>;
using NormalMap = MemberMap<Kernel::Vector_3, &OrientedPoint::normal>;

constexpr std::size_t kFewestPoints = 3;

OrientedPoints with_normals(std::span<const Vec3f> points, int neighbors) {
  OrientedPoints oriented(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points[i];
    oriented[i] = {{p.x(), p.y(), p.z()}, {}, i};
  }
  CGAL::pca_estimate_normals<CGAL::Sequential_tag>(
      oriented, static_cast<unsigned>(neighbors),
      CGAL::parameters::point_map(PointMap()).normal_map(NormalMap()));
  return oriented;
}

}  // namespace

planes::FoundPlanes cgal_ransac(std::span<const Vec3f> points, bool by_point) {
  std::vector<std::int32_t> group_of(points.size(), 0);
  if (points.size() < kFewestPoints) return planes::found_planes(points, group_of);
  OrientedPoints oriented = with_normals(points, 12);

  using Traits = detection::Efficient_RANSAC_traits<Kernel, OrientedPoints, PointMap, NormalMap>;
  // CGAL draws from one sequence per thread.
  CGAL::get_default_random() = CGAL::Random(1);
  detection::Efficient_RANSAC<Traits> ransac;
  ransac.set_input(oriented);
  ransac.add_shape_factory<detection::Plane<Traits>>();
  detection::Efficient_RANSAC<Traits>::Parameters parameters;
  parameters.probability = 0.001;
  parameters.min_points = by_point ? 200 : 30;
  parameters.epsilon = by_point ? 0.008 : 0.01;
  parameters.cluster_epsilon = by_point ? 0.05 : 0.1;
  parameters.normal_threshold = 0.75;
  ransac.detect(parameters);

  std::int32_t group = 0;
  for (const auto& shape : ransac.shapes()) {
    ++group;
    for (const std::size_t i : shape->indices_of_assigned_points())
      group_of[oriented[i].index] = group;
  }
  return planes::found_planes(points, group_of);
}

planes::FoundPlanes cgal_region_growing(std::span<const Vec3f> points, bool by_point) {
  std::vector<std::int32_t> group_of(points.size(), 0);
  if (points.size() < kFewestPoints) return planes::found_planes(points, group_of);
  const OrientedPoints oriented = with_normals(points, 20);

  namespace on_points = detection::Point_set;
  using Neighbors = on_points::K_neighbor_query<Kernel, OrientedPoints, PointMap>;
  using Region =
      on_points::Least_squares_plane_fit_region<Kernel, OrientedPoints, PointMap, NormalMap>;
  using Order =
      on_points::Least_squares_plane_fit_sorting<Kernel, OrientedPoints, Neighbors, PointMap>;
  Neighbors neighbors(oriented, 12);
  Region region(oriented, by_point ? 0.012 : 0.015, by_point ? 45 : 42, by_point ? 100 : 30);
  Order order(oriented, neighbors);  // the most planar surroundings first
  order.sort();
  detection::Region_growing<OrientedPoints, Neighbors, Region, Order::Seed_map> growing(
      oriented, neighbors, region, order.seed_map());
  std::vector<std::vector<std::size_t>> regions;
  growing.detect(std::back_inserter(regions));

  std::int32_t group = 0;
  for (const std::vector<std::size_t>& members : regions) {
    ++group;
    for (const std::size_t i : members) group_of[i] = group;
  }
  return planes::found_planes(points, group_of);
}

}  // namespace planescope::lab
