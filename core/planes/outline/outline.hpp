#pragma once

// What a plane covers: its pixels seen from the sensor, laid onto the plane, with the holes in
// which something else was seen, and those where nothing was measured.

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
  double tolerance_m = 0.01;  // no corner of an outline is farther than this from where it was, no
                              // hole smaller than this squared
  double gap_m = 0.05;  // holes where nothing else was seen, and smaller than this squared, are
                        // closed
  double least_m2 = 0.0004;  // smaller parts are left out
  int least_seen_px = 3;     // so many pixels that see something else make a hole
};

/// Coordinates on the plane: origin + x basis.u + y basis.v.
struct Outline {
  struct Part {
    PolygonRing outer;                 // counter-clockwise from where the normal points
    std::vector<PolygonRing> holes;    // where something else was seen, or through the plane
    std::vector<PolygonRing> unknown;  // holes where nothing was
  };
  Vec3d origin = Vec3d::Zero();  // world [m]
  PlaneBasis basis;
  std::vector<Part> parts;  // the largest first
  double area_m2 = 0;       // without holes and what is unknown

  Vec3d world(const Vec2d& p) const { return origin + p.x() * basis.u + p.y() * basis.v; }
};

/// In another world: of points X, now at T X.
Outline moved(Outline outline, const Pose& T);

/// The parts as polygons, unknown holes being holes.
Polygons polygons_of(const Outline& outline);

/// One for each plane, by id - 1. Depth images: from the pixels' edges, along their rays onto the
/// plane; where these graze it, and of clouds, from the cells of a grid on the plane that hold
/// points, `cell_m` wide.
std::vector<Outline> outlines_of(const Frame& frame,
                                 const FrameResult& result,
                                 double cell_m,
                                 const OutlineOptions& options = {});

/// Of what these places on a plane cover, from a grid as above.
Outline outline_of_points(const Vec3d& origin,
                          const PlaneBasis& basis,
                          std::span<const Vec2d> points,
                          double cell_m,
                          const OutlineOptions& options = {});

/// Of the planes that are minor, by their cells: they have no pixels. `cell_m` as above.
std::vector<Outline> minor_outlines_of(const FrameResult& result,
                                       double cell_m,
                                       const OutlineOptions& options = {});

// ---- Triangles ----

struct Mesh {
  std::vector<Vec3d> vertices;                // world [m], none twice
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise from where the normal points
};

/// What a plane covers, without its holes and what is unknown: constrained Delaunay triangles with
/// the outline's corners.
Mesh mesh_of(const Outline& outline);

// ---- Pixels ----

/// Those whose centres are within, row by row; holes where nothing was measured as well where
/// `with_unknown`. Nothing where a corner is not ahead of the camera.
std::optional<std::vector<PixelRun>> pixels_within(const Outline& outline,
                                                   const Intrinsics& camera,
                                                   const Pose& T_sensor_world,
                                                   bool with_unknown);

}  // namespace planescope::planes
