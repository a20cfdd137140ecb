#pragma once

// Planes as found by a perfect method, for tests of step detection.

#include <cmath>
#include <numbers>
#include <vector>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes::test {

struct IdealPlanes {
  std::vector<PlaneRegion> planes;
  std::vector<Outline> outlines;
  std::optional<Vec3d> sensor = Vec3d(-0.5, 0, 1.2);

  /// Adds a planar polygon with counter-clockwise corners, seen against its normal. Returns its id.
  int add(const std::vector<Vec3d>& corners) {
    PlaneRegion plane;
    plane.id = static_cast<int>(planes.size()) + 1;
    plane.fit.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    plane.label = label_of_normal(plane.fit.normal);
    Outline outline;
    for (const Vec3d& corner : corners)
      outline.origin += corner / static_cast<double>(corners.size());
    plane.fit.centroid = outline.origin;
    outline.basis = plane_basis(plane.fit.normal);
    PolygonRing ring;
    for (const Vec3d& corner : corners) {
      const Vec3d d = corner - outline.origin;
      ring.emplace_back(outline.basis.u.dot(d), outline.basis.v.dot(d));
    }
    outline.area_m2 = polygon_area(ring);
    outline.parts.push_back({ring, {}, {}});
    planes.push_back(plane);
    outlines.push_back(outline);
    return plane.id;
  }
  /// Adds a rectangle facing up.
  int level(double x0, double x1, double y0, double y1, double z) {
    return add({{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}});
  }
  /// Adds a rectangle at x, facing -x.
  int riser(double x, double y0, double y1, double z0, double z1) {
    return add({{x, y1, z0}, {x, y0, z0}, {x, y0, z1}, {x, y1, z1}});
  }
  /// Rotates all planes so far about the vertical axis at the origin.
  void turn(double deg) {
    const Eigen::AngleAxisd about(deg * std::numbers::pi / 180, Vec3d::UnitZ());
    for (std::size_t i = 0; i < planes.size(); ++i) {
      planes[i].fit.normal = about * planes[i].fit.normal;
      planes[i].fit.centroid = about * planes[i].fit.centroid;
      Outline& outline = outlines[i];
      outline.origin = about * outline.origin;
      outline.basis = {about * outline.basis.u, about * outline.basis.v};
    }
    if (sensor) sensor = about * *sensor;
  }
  CoveringPlanes covering() const { return {planes, outlines}; }
  Stairs find(const CoveringPlanes& minor = {}) const {
    return find_stairs(covering(), minor, sensor, {});
  }
};

/// A floor of 1 m, and `count` steps up along x, from x = 0.
inline IdealPlanes flight_up(int count, double rise = 0.17, double going = 0.28) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -0.6, 0.6, 0);
  for (int i = 0; i < count; ++i) {
    ideal.riser(i * going, -0.5, 0.5, i * rise, (i + 1) * rise);
    ideal.level(i * going, (i + 1) * going, -0.5, 0.5, (i + 1) * rise);
  }
  return ideal;
}

}  // namespace planescope::planes::test
