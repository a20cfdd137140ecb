#pragma once

// Outline of a plane: its pixels projected onto the plane, with holes where something else was
// seen, and holes where nothing was measured.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"
#include "core/planes/outline/polygons.hpp"
#include "core/planes/outline/rings.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

struct OutlineOptions {
  double tolerance_m = 0.01;  // largest displacement of an outline's corners; smaller holes (this
                              // squared) are dropped
  double gap_m = 0.05;  // holes smaller than this squared are closed unless something else was seen
                        // in them
  double least_m2 = 0.0004;  // smaller parts are dropped
  int least_seen_px = 3;     // number of pixels showing something else that make a hole
};

/// Plane coordinates: origin + x basis.u + y basis.v.
struct Outline {
  struct Part {
    PolygonRing outer;                 // counter-clockwise seen from the side of the normal
    std::vector<PolygonRing> holes;    // something else was seen there, or seen through the plane
    std::vector<PolygonRing> unknown;  // holes where nothing was measured
  };
  Vec3d origin = Vec3d::Zero();  // world [m]
  PlaneBasis basis;
  std::vector<Part> parts;  // largest first
  double area_m2 = 0;       // excludes holes and unknown holes

  Vec3d world(const Vec2d& p) const { return origin + p.x() * basis.u + p.y() * basis.v; }
};

/// Transforms the outline: points X move to T X.
Outline moved(Outline outline, const Pose& T);

/// The parts as polygons, with unknown holes as holes.
Polygons polygons_of(const Outline& outline);

/// One per plane, by id - 1. For depth images, traced along pixel edges and projected along their
/// rays onto the plane. For clouds and at grazing angles, traced on a grid on the plane with cells
/// of `cell_m`.
std::vector<Outline> outlines_of(const Frame& frame,
                                 const FrameResult& result,
                                 double cell_m,
                                 const OutlineOptions& options = {});

/// Outline of points in plane coordinates, from a grid as above.
Outline outline_of_points(const Vec3d& origin,
                          const PlaneBasis& basis,
                          std::span<const Vec2d> points,
                          double cell_m,
                          const OutlineOptions& options = {});

/// Outlines of minor planes, from a grid as above because they have no pixels.
std::vector<Outline> minor_outlines_of(const FrameResult& result,
                                       double cell_m,
                                       const OutlineOptions& options = {});

// ---- Triangles ----

struct Mesh {
  std::vector<Vec3d> vertices;                // world [m], unique
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from the side of the normal
};

/// Constrained Delaunay triangulation of an outline without its holes and unknown holes; the
/// vertices are the outline's corners.
Mesh mesh_of(const Outline& outline);

// ---- Pixels ----

/// Pixels whose centers are within the outline, row by row; `with_unknown` includes unmeasured
/// holes. nullopt if a corner is not in front of the camera.
std::optional<std::vector<PixelRun>> pixels_within(const Outline& outline,
                                                   const Intrinsics& camera,
                                                   const Pose& T_sensor_world,
                                                   bool with_unknown);

}  // namespace planescope::planes
