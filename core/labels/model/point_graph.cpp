// Neighbors of the points of a cloud, and the surface around each point.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>
#include <numeric>
#include <tuple>

#include "core/labels/model/grid.hpp"
#include "core/model/plane.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kNearestPlaces = 12;  // around each place
constexpr std::size_t kLeastFit = 5;        // for a normal
constexpr double kFlat = 0.35;              // maximum thickness over width for a normal
constexpr std::size_t kSmoothestPart = 5;   // assume one point in five is on a smooth surface
constexpr double kLeastNoise_m = 0.0005, kMostNoise_m = 0.05;

/// Points at the same position, such as corners of a mesh, are one place.
struct Places {
  std::vector<std::uint32_t> first;     // the first point of each, ascending
  std::vector<std::uint32_t> place_of;  // per point; kNone if not measured
  std::vector<std::uint32_t> count;     // points at each

  static constexpr std::uint32_t kNone = ~0u;
};

Places places_of(std::span<const Vec3f> points, std::span<const std::uint8_t> measured) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (measured[i]) order.push_back(i);
  const auto key = [&](std::uint32_t i) {
    return std::tuple(points[i].x(), points[i].y(), points[i].z());
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key(a), a) < std::tuple(key(b), b);
  });
  std::vector<std::uint32_t> representative(points.size(), Places::kNone);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
    representative[order[k]] = same ? representative[order[k - 1]] : order[k];
  }
  Places places;
  places.place_of.assign(points.size(), Places::kNone);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (representative[i] == Places::kNone) continue;
    if (representative[i] == i) {
      places.place_of[i] = static_cast<std::uint32_t>(places.first.size());
      places.first.push_back(i);
      places.count.push_back(0);
    }
    places.place_of[i] = places.place_of[representative[i]];
    ++places.count[places.place_of[i]];
  }
  return places;
}

/// nanoflann's interface to places.
struct PlacesView {
  std::span<const Vec3f> points;
  std::span<const std::uint32_t> first;

  std::size_t kdtree_get_point_count() const { return first.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[first[i]][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;  // the tree computes it
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PlacesView>,
                                                 PlacesView,
                                                 3,
                                                 std::uint32_t>;

struct LocalSurface {
  Vec3f normal = Vec3f::Zero();
  double rms_m = -1;  // -1: unknown
};

/// By principal components of a place and its neighbors.
LocalSurface local_surface(std::span<const Vec3f> points,
                           const Places& places,
                           std::span<const std::uint32_t> found,
                           const Vec3f& about) {
  LocalSurface surface;
  if (found.size() < kLeastFit) return surface;
  Moments moments;
  for (const std::uint32_t j : found) moments.add((points[places.first[j]] - about).cast<double>());
  const PlaneFit fit = fit_plane(moments);
  const double thickness = std::sqrt(std::max(0.0, fit.eigenvalues[0]));
  const double width = std::sqrt(std::max(0.0, fit.eigenvalues[1]));
  if (!(width > 0)) return surface;
  surface.rms_m = fit.rms_m();
  if (thickness <= kFlat * width) surface.normal = fit.normal.cast<float>();
  return surface;
}

/// Symmetric, from places to points: the points at a place are neighbors of its first point.
PointGraph graph_of(const Places& places,
                    const std::vector<std::array<std::uint32_t, kNearestPlaces>>& nearest,
                    const std::vector<std::uint8_t>& nearest_count) {
  const auto visit_pairs = [&](const auto& visit) {
    for (std::size_t p = 0; p < nearest.size(); ++p)
      for (std::size_t k = 0; k < nearest_count[p]; ++k)
        visit(places.first[p], places.first[nearest[p][k]]);
    for (std::uint32_t i = 0; i < places.place_of.size(); ++i)
      if (const std::uint32_t place = places.place_of[i];
          place != Places::kNone && places.first[place] != i)
        visit(places.first[place], i);
  };
  const std::size_t points = places.place_of.size();
  PointGraph graph;
  graph.first.assign(points + 1, 0);
  visit_pairs([&](std::uint32_t a, std::uint32_t b) {
    ++graph.first[a + 1];
    ++graph.first[b + 1];
  });
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.list.resize(graph.first.back());
  std::vector<std::uint32_t> end(graph.first.begin(), graph.first.end() - 1);
  visit_pairs([&](std::uint32_t a, std::uint32_t b) {
    graph.list[end[a]++] = b;
    graph.list[end[b]++] = a;
  });
  // Most pairs were found from both sides.
  std::uint32_t kept = 0;
  for (std::size_t i = 0, from = 0; i < points; ++i) {
    const auto begin = graph.list.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = graph.list.begin() + graph.first[i + 1];
    from = graph.first[i + 1];
    std::sort(begin, last);
    const auto once = std::unique(begin, last);
    std::copy(begin, once, graph.list.begin() + kept);
    graph.first[i] = kept;
    kept += static_cast<std::uint32_t>(once - begin);
  }
  graph.first[points] = kept;
  graph.list.resize(kept);
  return graph;
}

template <typename T>
T middle_of(std::vector<T>& values, std::size_t part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / part);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

PointSurface surface_of_points(std::span<const Vec3f> points,
                               std::span<const std::uint8_t> measured) {
  const Places places = places_of(points, measured);
  const PlacesView view{points, places.first};
  const Tree tree(3, view, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  const std::size_t count = places.first.size();

  PointSurface surface;
  surface.normals.resize(points.size(), Vec3f::Zero());
  surface.area_m2.resize(points.size(), 0);
  std::vector<std::array<std::uint32_t, kNearestPlaces>> nearest(count);
  std::vector<std::uint8_t> nearest_count(count, 0);
  std::vector<float> areas(count, 0);
  std::vector<double> roughness;
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint32_t p = tree.vAcc[n];  // in tree order, so that searches share the cache
    const Vec3f& point = points[places.first[p]];
    std::array<std::uint32_t, kNearestPlaces + 1> found;
    std::array<float, kNearestPlaces + 1> squared;
    const std::size_t size =
        tree.knnSearch(point.data(), kNearestPlaces + 1, found.data(), squared.data());
    for (std::size_t k = 0; k < size; ++k)
      if (found[k] != p) nearest[p][nearest_count[p]++] = found[k];
    const LocalSurface local = local_surface(points, places, std::span(found).first(size), point);
    surface.normals[places.first[p]] = local.normal;
    if (local.rms_m >= 0) roughness.push_back(local.rms_m);
    if (size > 1)
      areas[p] =
          static_cast<float>(std::numbers::pi * squared[size - 1]) / static_cast<float>(size);
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t place = places.place_of[i];
    if (place == Places::kNone) continue;
    surface.normals[i] = surface.normals[places.first[place]];
    surface.area_m2[i] = areas[place] / static_cast<float>(places.count[place]);
  }
  surface.graph = graph_of(places, nearest, nearest_count);
  surface.noise_m = kLeastNoise_m;
  if (!roughness.empty())
    surface.noise_m = std::clamp(middle_of(roughness, kSmoothestPart), kLeastNoise_m, kMostNoise_m);
  if (!areas.empty()) surface.spacing_m = std::sqrt(static_cast<double>(middle_of(areas, 2)));
  return surface;
}

}  // namespace planescope::labels
