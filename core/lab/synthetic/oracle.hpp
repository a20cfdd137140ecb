#pragma once

// The best that geometry alone can do: each point to its nearest true plane, where that plane ends
// as the generator made it.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::lab {

/// A piece of a true plane; several may share their plane.
struct TruePolygon {
  std::vector<Vec3d> corners;  // convex, [m]
  int plane = 0;               // id from 1; 0: part of something curved
};

/// Distance from a point to the nearest point of the polygon [m].
double distance_m(const TruePolygon& polygon, const Vec3d& point);

/// Per point the plane of the polygon that is nearest to it (of equally near ones the first), 0
/// where that is something curved.
std::vector<std::int32_t> oracle_planes(std::span<const Vec3f> points,
                                        std::span<const TruePolygon> polygons);

}  // namespace planescope::lab
