#pragma once

// Which points of a cloud lie beside each other, and what the surface around each is like.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::labels {

/// Neighbours of point i: list[first[i] .. first[i+1]), ascending, each a neighbour of the other,
/// none of itself. Empty: there is no cloud.
struct PointGraph {
  std::vector<std::uint32_t> first, list;

  bool empty() const { return first.empty(); }
  std::span<const std::uint32_t> around(std::uint32_t point) const {
    return std::span(list).subspan(first[point], first[point + 1] - first[point]);
  }
};

/// About how many spacings a step from a point to its neighbours reaches.
inline constexpr int kSpacingsOfStep = 2;

struct PointSurface {
  PointGraph graph;  // of the 12 nearest places; of points at one place the first has them,
                     // and is the neighbour of the others
  std::vector<Vec3f> normals;  // unit, either way; zero where unknown
  std::vector<float> area_m2;  // of the surface that a point stands for
  double noise_m = 0;          // across a smooth surface
  double spacing_m = 0;        // from point to point, the median
};
/// `measured`: 0 where a point is none; such points have no neighbours.
PointSurface surface_of_points(std::span<const Vec3f> points,
                               std::span<const std::uint8_t> measured);

}  // namespace planescope::labels
