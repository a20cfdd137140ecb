#pragma once

// Outlines as triangles.

#include <array>
#include <vector>

#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

struct Mesh {
  std::vector<Vec3d> vertices;                // world [m], none twice
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise from where the normal points
};

/// What a plane covers, without its holes and what is unknown: constrained Delaunay triangles with
/// the outline's corners.
Mesh mesh_of(const Outline& outline);

}  // namespace planescope::planes
