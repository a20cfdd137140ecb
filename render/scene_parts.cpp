#include "render/scene_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>

#include "core/model/plane.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {
namespace {

constexpr Rgba kGravity{90, 60, 140, 255};
constexpr std::size_t kMostPlanesInLegend = 8;

double cross(const Vec2d& from, const Vec2d& to, const Vec2d& p) {
  return (to.x() - from.x()) * (p.y() - from.y()) - (to.y() - from.y()) * (p.x() - from.x());
}

/// Takes out what is no corner of the convex hull for certain: what is inside the octagon of the
/// farthest points in eight directions (Akl & Toussaint 1978). Of a plane of 100,000 pixels few
/// stay.
void drop_inner_points(std::vector<Vec2d>& points) {
  constexpr std::size_t kSides = 8;
  constexpr double kDiagonal = std::numbers::sqrt2 / 2;
  const std::array<Vec2d, kSides / 2> directions = {
      Vec2d(1, 0), {kDiagonal, kDiagonal}, {0, 1}, {-kDiagonal, kDiagonal}};
  if (points.size() < 64) return;
  std::array<Vec2d, kSides> farthest;
  farthest.fill(points.front());
  std::array<double, kSides> reach;
  reach.fill(-1e300);
  for (const Vec2d& p : points)
    for (std::size_t k = 0; k < kSides; ++k) {
      const double at = k < kSides / 2 ? p.dot(directions[k]) : -p.dot(directions[k - kSides / 2]);
      if (at <= reach[k]) continue;
      reach[k] = at;
      farthest[k] = p;
    }
  std::erase_if(points, [&](const Vec2d& p) {
    for (std::size_t k = 0; k < kSides; ++k) {
      const Vec2d &from = farthest[k], &to = farthest[(k + 1) % kSides];
      if (from != to && cross(from, to, p) <= 0) return false;
    }
    return true;
  });
}

}  // namespace

int color_id_of(int plane_id, std::span<const int> color_of_plane) {
  const auto index = static_cast<std::size_t>(plane_id - 1);
  return index < color_of_plane.size() ? color_of_plane[index] : plane_id;
}

Rgba color_of(int plane_id, std::span<const int> color_of_plane) {
  return plane_color(color_id_of(plane_id, color_of_plane));
}

RobustBounds robust_bounds(std::span<const Vec3f> points) {
  RobustBounds bounds;
  if (points.empty()) return bounds;
  constexpr std::size_t kEnough = 20000;  // points to go by
  const std::size_t stride = 1 + (points.size() - 1) / kEnough;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < points.size(); i += stride) values.push_back(points[i][axis]);
    bounds.low[axis] = quantile(values, 0.01);
    bounds.high[axis] = quantile(values, 0.99);
  }
  return bounds;
}

bool is_named(std::size_t voxels, std::size_t all) {
  return static_cast<double>(voxels) >= 0.008 * static_cast<double>(all);
}

std::int32_t plane_label_rank(std::size_t voxels, std::size_t all) {
  return kPlaneLabel +
         static_cast<std::int32_t>(1000 * (all - voxels) / std::max<std::size_t>(1, all));
}

Vec3f place_on_plane(const Vec3d& centroid, std::span<const Vec3f> own, float voxel_m) {
  constexpr int kThere = 5;             // voxels about the centroid
  constexpr float kThereVoxels = 2.5F;  // within so many edges
  constexpr float kCellVoxels = 6;
  constexpr std::size_t kEnough = 4000;  // points to find the place by
  const Vec3f middle = centroid.cast<float>();
  const float reach = kThereVoxels * voxel_m;
  const auto is_near = [&](const Vec3f& p) { return (p - middle).squaredNorm() < reach * reach; };
  if (own.empty() || voxel_m <= 0 || std::ranges::count_if(own, is_near) >= kThere) return middle;
  struct Cell {
    int count = 0;
    Vec3f sum = Vec3f::Zero();
  };
  std::map<std::array<int, 3>, Cell> cells;
  const float edge = kCellVoxels * voxel_m;
  const std::size_t stride = 1 + (own.size() - 1) / kEnough;
  for (std::size_t i = 0; i < own.size(); i += stride) {
    const Vec3f& p = own[i];
    const Eigen::Array3i at = ((p - middle) / edge).array().round().cast<int>();
    Cell& cell = cells[{at[0], at[1], at[2]}];
    ++cell.count;
    cell.sum += p;
  }
  const auto fuller = [](const auto& a, const auto& b) { return a.second.count < b.second.count; };
  const Cell& most = std::ranges::max_element(cells, fuller)->second;
  const Vec3f mean = most.sum / static_cast<float>(most.count);
  return *std::ranges::min_element(own, {},
                                   [&](const Vec3f& p) { return (p - mean).squaredNorm(); });
}

float normal_arrow_m(std::span<const Vec3f> voxels) {
  return std::clamp(0.05F * robust_bounds(voxels).diagonal(), 0.06F, 1.0F);
}

double least_numeral_edge_m(std::span<const Vec3f> voxels) {
  return 0.05 * robust_bounds(voxels).diagonal();
}

double numeral_edge_m(const planes::Octree& octree,
                      const planes::OctreeNode& node,
                      const DrawBox& tile) {
  if (!octree.image) return octree.node_edge_m(node);
  const std::array<Vec3f, 8>& at = tile.corners;
  return std::max((at[1] - at[0]).norm(), (at[2] - at[0]).norm());
}

std::string case_numeral(const planes::OctreeNode& node) {
  return std::string(planes::to_string(node.decided)) + (node.by_label ? "*" : "");
}

void add_gravity(const planes::FrameResult& result, DrawList& list) {
  // At the left edge of the frame's picture, below the title.
  const Camera camera = frame_camera(result, 4.0 / 3);
  const Vec3d toward = camera.target - camera.eye;
  const double distance = 0.6 * toward.norm();
  const Vec3d forward = toward.normalized();
  const Vec3d right = forward.cross(camera.up).normalized();
  const double half_height = distance * std::tan(camera.fov_y_deg * std::numbers::pi / 360);
  const Vec3d from = camera.eye + distance * forward - 1.12 * half_height * right +
                     0.62 * half_height * right.cross(forward);
  const Vec3d to = from - 0.25 * half_height * Vec3d::UnitZ();
  if (!result.gravity.known()) {
    list.labels.push_back({from.cast<float>(), "gravity not known", kGravity, 15});
    return;
  }
  list.arrows.push_back({from.cast<float>(), to.cast<float>(), kGravity, 4});
  const GravitySource source = result.gravity.source;
  const bool sure = source != GravitySource::estimate && source != GravitySource::assumed &&
                    source != GravitySource::carried;
  const std::string text = sure ? "gravity" : fmt::format("gravity ({})", to_string(source));
  const Vec3d below = to - 0.06 * half_height * Vec3d::UnitZ();
  list.labels.push_back({below.cast<float>(), text, kGravity, 15});
}

DrawPoints kept_points(const planes::Cloud& cloud, std::vector<std::size_t>& at) {
  DrawPoints points;
  points.size_m = 0.012F;
  points.min_px = 2.5F;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    points.positions.push_back(cloud.points[i]);
    at.push_back(i);
  }
  return points;
}

DrawPoints voxel_points(const planes::VoxelCloud& voxels) {
  DrawPoints points;
  points.positions = voxels.points;
  // A little wider than the voxels they stand for, so that surfaces close.
  points.size_m = voxels.size_m > 0 ? static_cast<float>(1.4 * voxels.size_m) : 0.01F;
  points.max_px = 40;
  return points;
}

DrawBox cell_box(const planes::Octree& octree, const planes::OctreeNode& node) {
  DrawBox box;
  box.corners = planes::cell_corners(octree, node);
  return box;
}

DrawBox points_box(const planes::Octree& octree,
                   const planes::OctreeNode& node,
                   double voxel_size_m) {
  const planes::ImageSpace* image = octree.image ? &*octree.image : nullptr;
  Bounds own;
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const Vec3d p = octree.points[i].cast<double>();
    own.add(image ? image->from_local(p) : p);
  }
  // Half a voxel or pixel around each point: neighboring tiles meet. Along 1 / z it is thin.
  const Vec3d margin =
      image ? Vec3d(0.5, 0.5, 0.1 / image->px_per_inverse_m) : Vec3d::Constant(voxel_size_m / 2);
  const Bounds cell = planes::cell_bounds(octree, node);
  own.min = cell.min.cwiseMax(own.min - margin);
  own.max = cell.max.cwiseMin(own.max + margin);
  DrawBox box;
  box.corners = planes::corners_of(octree, own);
  return box;
}

std::vector<Vec3f> outline_on_plane(const PlaneFit& plane, std::span<const Vec3f> points) {
  const PlaneBasis basis = plane_basis(plane.normal);
  std::vector<Vec2d> flat;
  flat.reserve(points.size());
  for (const Vec3f& point : points) {
    const Vec3d d = point.cast<double>() - plane.centroid;
    flat.emplace_back(d.dot(basis.u), d.dot(basis.v));
  }
  drop_inner_points(flat);
  std::vector<Vec3f> corners;
  for (const Vec2d& p : convex_hull(std::move(flat)))
    corners.push_back((plane.centroid + p.x() * basis.u + p.y() * basis.v).cast<float>());
  return corners;
}

std::string percent(std::size_t part, std::size_t whole) {
  if (whole == 0) return "0 %";
  const double value = 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  const long tenths = std::lround(10 * value);
  return fmt::format("{}.{} %", tenths / 10, tenths % 10);
}

void add_case_legend(std::span<const std::size_t> count, bool on_image, DrawList& list) {
  const auto entry = [&](planes::Case c, const std::string& meaning) {
    using Mark = LegendEntry::Mark;
    list.legend.push_back({c == planes::Case::II ? Mark::hatched_box : Mark::box, case_color(c),
                           fmt::format("{}  {}  {}", planes::to_string(c), meaning,
                                       count[static_cast<std::size_t>(c)])});
  };
  entry(planes::Case::I, on_image ? "two planes" : "impure");
  entry(planes::Case::II, on_image ? "not filled" : "too few points");
  entry(planes::Case::III, on_image ? "not flat" : "not planar");
  entry(planes::Case::IV, "plane candidate");
}

void add_plane_legend(const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list) {
  using Mark = LegendEntry::Mark;
  const auto& planes = result.segmentation.planes;
  std::vector<std::size_t> order(planes.size());  // those with most points first
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return planes[i].points; });
  for (std::size_t i = 0; i < std::min(order.size(), kMostPlanesInLegend); ++i) {
    const planes::PlaneRegion& plane = planes[order[i]];
    const char* label = plane.label == Label::h ? "h  " : plane.label == Label::v ? "v  " : "";
    list.legend.push_back({Mark::box, color_of(plane.id, color_of_plane),
                           fmt::format("{}  {}{} voxels", plane.id, label, plane.points)});
  }
  if (order.size() > kMostPlanesInLegend)
    list.legend.push_back({Mark::box, kSceneFaded,
                           std::to_string(order.size() - kMostPlanesInLegend) + " smaller planes"});
}

}  // namespace planescope::render
