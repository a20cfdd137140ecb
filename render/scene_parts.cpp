// Common parts of a frame's scenes: points, boxes, names, legends, and planes.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <ranges>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr Rgba kGravity{90, 60, 140, 255};

double cross(const Vec2d& from, const Vec2d& to, const Vec2d& p) {
  return (to.x() - from.x()) * (p.y() - from.y()) - (to.y() - from.y()) * (p.x() - from.x());
}

/// Removes points inside the octagon of the farthest points in eight directions, which cannot
/// be corners of the convex hull (Akl & Toussaint 1978). Few points of a plane with 100,000
/// pixels remain.
void drop_inner_points(std::vector<Vec2d>& points) {
  if (points.size() < 64) return;
  std::array<Vec2d, 8> farthest;
  for (std::size_t k = 0; k < farthest.size(); ++k) {
    const double turn = static_cast<double>(k) * std::numbers::pi / 4;
    const Vec2d direction(std::cos(turn), std::sin(turn));
    farthest[k] =
        *std::ranges::max_element(points, {}, [&](const Vec2d& p) { return p.dot(direction); });
  }
  std::erase_if(points, [&](const Vec2d& p) {
    for (std::size_t k = 0; k < farthest.size(); ++k) {
      const Vec2d &from = farthest[k], &to = farthest[(k + 1) % farthest.size()];
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
  constexpr std::size_t kEnough = 20000;  // number of points to sample
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
  constexpr int kThere = 5;             // voxels near the centroid
  constexpr float kThereVoxels = 2.5F;  // within this many voxel edges
  constexpr float kCellVoxels = 6;
  constexpr std::size_t kEnough = 4000;  // number of points to sample
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
    list.labels.push_back({from.cast<float>(), "gravity unknown", kGravity, 15});
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

DrawPoints voxel_points(const planes::VoxelCloud& voxels) {
  DrawPoints points;
  points.positions = voxels.points;
  // Slightly wider than the voxels, so that surfaces have no gaps.
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
  // Half a voxel or pixel around each point, so that neighboring tiles meet. Thin along 1 / z.
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
    using Symbol = LegendEntry::Symbol;
    list.explain(case_color(c),
                 fmt::format("{}  {}  {}", planes::to_string(c), meaning,
                             count[static_cast<std::size_t>(c)]),
                 c == planes::Case::II ? Symbol::hatched_box : Symbol::box);
  };
  entry(planes::Case::I, on_image ? "two planes" : "impure");
  entry(planes::Case::II, on_image ? "not filled" : "too few points");
  entry(planes::Case::III, on_image ? "not flat" : "not planar");
  entry(planes::Case::IV, "plane candidate");
}

void add_plane_legend(const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list) {
  constexpr std::size_t kMost = 8;
  using Symbol = LegendEntry::Symbol;
  std::vector<const planes::PlaneRegion*> order;  // most points first
  for (const planes::PlaneRegion& plane : result.segmentation.planes) order.push_back(&plane);
  std::ranges::stable_sort(order, std::greater(), &planes::PlaneRegion::points);
  for (const planes::PlaneRegion* plane : order | std::views::take(kMost)) {
    const char* label = plane->label == Label::h ? "h  " : plane->label == Label::v ? "v  " : "";
    list.explain(color_of(plane->id, color_of_plane),
                 fmt::format("{}  {}{} voxels", plane->id, label, plane->points), Symbol::box);
  }
  if (order.size() > kMost)
    list.explain(kSceneFaded, std::to_string(order.size() - kMost) + " smaller planes",
                 Symbol::box);
}

// ---- Finished planes, foot space, stairs ----
namespace {

// ---- Rings as lines ----

/// Transforms plane coordinates of an outline to the scene.
struct OntoScene {
  const planes::Outline& outline;
  const Vec3d& origin;
  Vec3f operator()(const Vec2d& p) const { return (outline.world(p) - origin).cast<float>(); }
};

/// Outer ring and hole rings of an area or of a part of an outline.
void add_rings(const auto& area, const OntoScene& onto, std::vector<Vec3f>& lines) {
  const auto add = [&](const planes::PolygonRing& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      lines.push_back(onto(ring[i]));
      lines.push_back(onto(ring[(i + 1) % ring.size()]));
    }
  };
  add(area.outer);
  std::ranges::for_each(area.holes, add);
}

/// Dashes as long as their gaps, with a whole number of periods per ring.
void add_dashes(const planes::PolygonRing& ring, const OntoScene& onto, std::vector<Vec3f>& lines) {
  double around_m = 0;
  const auto edge = [&](std::size_t i) { return Vec2d(ring[(i + 1) % ring.size()] - ring[i]); };
  for (std::size_t i = 0; i < ring.size(); ++i) around_m += edge(i).norm();
  if (!(around_m > 0)) return;
  const double dash_m = around_m / (2 * std::ceil(around_m / 0.04));
  double at_m = 0;  // along the ring
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double length_m = edge(i).norm();
    // The edge's share of each dash k, which begins at 2 k dash_m.
    for (auto k = static_cast<int>(at_m / (2 * dash_m)); 2 * k * dash_m < at_m + length_m; ++k) {
      const double from = std::max(2 * k * dash_m, at_m) - at_m;
      const double to = std::min((2 * k + 1) * dash_m, at_m + length_m) - at_m;
      if (to <= from) continue;
      lines.push_back(onto(ring[i] + from / length_m * edge(i)));
      lines.push_back(onto(ring[i] + to / length_m * edge(i)));
    }
    at_m += length_m;
  }
}

void add_lines(std::vector<Vec3f> ends, Rgba color, float width_px, DrawList& list) {
  if (ends.empty()) return;
  DrawLines lines;
  lines.colors.assign(ends.size() / 2, color);
  lines.positions = std::move(ends);
  lines.width_px = width_px;
  lines.lifted = true;
  list.lines.push_back(std::move(lines));
}

// ---- Stairs ----

std::string rise_text(double rise_m) { return fmt::format("rise {:.0f} mm", 1000 * rise_m); }

struct StairsPen {
  const PlaneScene& scene;
  Theme theme;
  DrawList& list;

  Vec3f at(const Vec3d& world) const { return (world - scene.origin).cast<float>(); }
  Vec3d middle(const planes::NosingLine& nosing) const { return (nosing.right + nosing.left) / 2; }
  void add_text(const Vec3d& where, const std::string& text) const {
    list.labels.push_back({at(where), text, theme_colors(theme).ink, 14, kFigureLabel});
  }
  void add_nosing(const planes::NosingLine& nosing) const {
    add_lines({at(nosing.right), at(nosing.left)}, theme_colors(theme).ink, 2.5f, list);
  }
  void add_arrow(const Vec3d& from, const Vec3d& to) const {
    list.arrows.push_back({at(from), at(to), verdict_color(true), 3});
  }

  void add(const planes::Flight& flight) const {
    for (const planes::Flight::Step& step : flight.steps) {
      add_nosing(step.nosing);
      const std::string going =
          step.going_m > 0 ? fmt::format(", going {:.0f} mm", 1000 * step.going_m) : "";
      add_text(step.nosing.left, rise_text(step.rise_m) + going);
    }
    if (flight.steps.empty()) return;
    const Vec3d first = middle(flight.steps.front().nosing),
                last = middle(flight.steps.back().nosing);
    const Vec3d one_below = flight.going_m * flight.uphill + flight.rise_m * Vec3d::UnitZ();
    add_arrow(first - one_below, last);
  }
  void add(const planes::Kerb& kerb) const {
    add_nosing(kerb.nosing);
    add_text(kerb.nosing.left, "kerb, " + rise_text(kerb.rise_m));
    constexpr double kArrow_m = 0.2;
    add_arrow(middle(kerb.nosing) - kArrow_m * kerb.uphill,
              middle(kerb.nosing) + kArrow_m * kerb.uphill);
  }
  void add(const planes::SlopingPlane& ramp) const {
    const std::size_t k = static_cast<std::size_t>(ramp.plane) - 1;
    if (k >= scene.centroids.size()) return;
    const Vec3d centroid = scene.centroids[k].cast<double>() + scene.origin;
    const Vec3d half = 0.4 * (ramp.run_m * ramp.uphill + ramp.rise_m * Vec3d::UnitZ());
    add_arrow(centroid - half, centroid + half);
    add_text(centroid, fmt::format("ramp {:.0f}°, {}", ramp.slope_deg, rise_text(ramp.rise_m)));
  }
};

}  // namespace

std::vector<PlaneShape> plane_shapes(std::span<const planes::Outline> outlines,
                                     const Vec3d& origin) {
  std::vector<PlaneShape> shapes;
  for (const planes::Outline& outline : outlines) {
    const OntoScene onto{outline, origin};
    PlaneShape& shape = shapes.emplace_back();
    for (const planes::Outline::Part& part : outline.parts) {
      add_rings(part, onto, shape.rings);
      for (const planes::PolygonRing& hole : part.unknown) add_dashes(hole, onto, shape.unknown);
    }
  }
  return shapes;
}

void fill_shape(const planes::Outline& outline, const Vec3d& origin, PlaneShape& shape) {
  planes::Mesh mesh;
  try {
    mesh = planes::mesh_of(outline);
  } catch (const Error&) {
    return;  // draw the lines only, instead of failing the whole scene
  }
  for (const Vec3d& corner : mesh.vertices)
    shape.corners.push_back((corner - origin).cast<float>());
  for (const std::array<int, 3>& triangle : mesh.triangles)
    for (const int corner : triangle) shape.triangles.push_back(static_cast<std::uint32_t>(corner));
}

std::optional<bool> PlaneScene::verdict(int plane_id) const {
  const std::size_t k = static_cast<std::size_t>(plane_id) - 1;
  return k < steppable.size() ? std::optional<bool>(steppable[k]) : std::nullopt;
}

PlaneScene plane_scene(std::span<const planes::PlaneRegion> planes,
                       std::span<const planes::Outline> outlines,
                       std::span<const planes::Foothold> footholds,
                       const planes::Stairs& stairs,
                       const Vec3d& origin) {
  PlaneScene scene;
  scene.origin = origin;
  scene.stairs = stairs;
  scene.complete = true;
  scene.shapes = plane_shapes(outlines, origin);
  for (const planes::PlaneRegion& plane : planes)
    scene.centroids.push_back(plane.fit.centroid.cast<float>());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    fill_shape(outlines[k], origin, scene.shapes[k]);
    if (k >= footholds.size() || !footholds[k].space) continue;
    const OntoScene onto{outlines[k], origin};
    FootShape& foot = scene.foot.emplace_back();
    for (const planes::Polygon& part : footholds[k].space->area) add_rings(part, onto, foot.rings);
    for (const planes::PolygonRing& piece : footholds[k].space->pieces) {
      std::vector<Vec3f>& corners = foot.pieces.emplace_back();
      for (const Vec2d& p : piece) corners.push_back(onto(p));
    }
    scene.steppable.push_back(footholds[k].steppable);
  }
  return scene;
}

void add_shape(const PlaneShape& shape, const ShapeLook& look, DrawList& list) {
  if (!shape.triangles.empty()) {
    DrawPolygon polygon;
    polygon.corners = shape.corners;
    polygon.triangles = shape.triangles;
    polygon.fill = look.fill;
    polygon.id = look.id;
    list.polygons.push_back(std::move(polygon));
  }
  add_lines(shape.rings, look.line, look.width_px, list);
  add_lines(shape.unknown, with_alpha(look.line, look.line.a / 2), look.width_px, list);
}

void add_foot_space(const PlaneScene& scene, Theme theme, DrawList& list) {
  for (std::size_t k = 0; k < scene.foot.size(); ++k) {
    // Distinct from the verdict's color, which the points may have.
    const ThemeColors& colors = theme_colors(theme);
    const Rgba color =
        scene.steppable[k] ? mix(verdict_color(true), colors.ink, 0.4) : colors.muted;
    for (const std::vector<Vec3f>& piece : scene.foot[k].pieces) {
      DrawPolygon polygon;
      polygon.corners = piece;
      polygon.fill = with_alpha(color, 70);
      polygon.outline = with_alpha(color, 150);
      polygon.outline_px = 1;
      list.polygons.push_back(std::move(polygon));
    }
    add_lines(scene.foot[k].rings, color, 2, list);
  }
}

void add_stairs(const PlaneScene& scene, Theme theme, DrawList& list) {
  const StairsPen pen{scene, theme, list};
  for (const planes::Flight& flight : scene.stairs.flights) pen.add(flight);
  for (const planes::Kerb& kerb : scene.stairs.kerbs) pen.add(kerb);
  for (const planes::SlopingPlane& ramp : scene.stairs.ramps) pen.add(ramp);
}

}  // namespace planescope::render
