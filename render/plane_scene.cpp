// Finished planes, room for a foot and stairs as they are drawn.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/error.hpp"
#include "core/planes/outline/outline.hpp"
#include "render/palette.hpp"
#include "render/scene_parts.hpp"

namespace planescope::render {
namespace {

// ---- Rings as lines ----

/// From the plane of an outline to the scene.
struct OntoScene {
  const planes::Outline& outline;
  const Vec3d& origin;
  Vec3f operator()(const Vec2d& p) const { return (outline.world(p) - origin).cast<float>(); }
};

void add_ring(const planes::PolygonRing& ring, const OntoScene& onto, std::vector<Vec3f>& lines) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    lines.push_back(onto(ring[i]));
    lines.push_back(onto(ring[(i + 1) % ring.size()]));
  }
}

/// Dashes as long as the gaps between them, an even number all around.
void add_dashes(const planes::PolygonRing& ring, const OntoScene& onto, std::vector<Vec3f>& lines) {
  double around_m = 0;
  const auto edge = [&](std::size_t i) { return Vec2d(ring[(i + 1) % ring.size()] - ring[i]); };
  for (std::size_t i = 0; i < ring.size(); ++i) around_m += edge(i).norm();
  if (!(around_m > 0)) return;
  const double dash_m = around_m / (2 * std::ceil(around_m / 0.04));
  double at_m = 0;  // along the ring
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double length_m = edge(i).norm();
    // Its share of each dash k, from 2 k dash_m on.
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
      add_ring(part.outer, onto, shape.rings);
      for (const planes::PolygonRing& hole : part.holes) add_ring(hole, onto, shape.rings);
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
    return;  // its lines tell as much; one fill is not worth all that is drawn with it
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
    for (const planes::Polygon& part : footholds[k].space->area) {
      add_ring(part.outer, onto, foot.rings);
      for (const planes::PolygonRing& hole : part.holes) add_ring(hole, onto, foot.rings);
    }
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
    // Apart from the verdict's own color, which the points may have.
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
