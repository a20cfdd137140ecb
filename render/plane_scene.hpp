#pragma once

// Finished planes as they are drawn: what they cover with its holes, where a foot may go on them,
// what leads from one to another. Pure functions; coordinates are the scene's, about Cloud::origin.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/stairs/stairs.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// What a plane covers. Lines are pairs of ends.
struct PlaneShape {
  std::vector<Vec3f> rings;    // outer ones, and those of holes where something else was seen
  std::vector<Vec3f> unknown;  // dashes about holes where nothing was measured
  // Filled by triangles, three corners each; empty where it is not.
  std::vector<Vec3f> corners;
  std::vector<std::uint32_t> triangles;
};

/// One for each plane, by id - 1, not filled yet. `origin`: of the scene, in the world.
std::vector<PlaneShape> plane_shapes(std::span<const planes::Outline> outlines,
                                     const Vec3d& origin);
/// Leaves a shape unfilled where its outline has no triangulation.
void fill_shape(const planes::Outline& outline, const Vec3d& origin, PlaneShape& shape);

struct FootShape {
  std::vector<Vec3f> rings;                // of the area for its centre, pairs of ends
  std::vector<std::vector<Vec3f>> pieces;  // convex
};

/// All that is known of a run's planes; what is empty is not known yet.
struct PlaneScene {
  std::vector<PlaneShape> shapes;  // by id - 1
  std::vector<FootShape> foot;     // likewise; empty where no foot is given
  std::vector<bool> steppable;     // likewise
  planes::Stairs stairs;           // in the world
  std::vector<Vec3f> centroids;    // of planes, by id - 1
  Vec3d origin = Vec3d::Zero();
  bool complete = false;  // nothing is being found out any more

  bool has_stairs() const {
    return !stairs.flights.empty() || !stairs.kerbs.empty() || !stairs.ramps.empty();
  }
  /// Whether a plane carries a foot; nothing where that is not known.
  std::optional<bool> verdict(int plane_id) const;
};

/// Of planes in the order of their ids. `footholds`: likewise.
PlaneScene plane_scene(std::span<const planes::PlaneRegion> planes,
                       std::span<const planes::Outline> outlines,
                       std::span<const planes::Foothold> footholds,
                       const planes::Stairs& stairs,
                       const Vec3d& origin);

struct ShapeLook {
  Rgba fill, line;
  float width_px = 1.5f;
  std::uint32_t id = 0;
};
void add_shape(const PlaneShape& shape, const ShapeLook& look, DrawList& list);

/// Where the centre of a foot may go: an area in a line, its convex pieces faint and thin; grey on
/// planes that carry none.
void add_foot_space(const PlaneScene& scene, Theme theme, DrawList& list);

/// Nosings with what each step rises and how far it goes, an arrow up each flight and ramp, kerbs.
void add_stairs(const PlaneScene& scene, Theme theme, DrawList& list);

}  // namespace planescope::render
