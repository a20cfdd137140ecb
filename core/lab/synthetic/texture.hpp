#pragma once

#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

/// Linear albedo of a surface at a point on it: its material's colour with a procedural pattern.
Vec3d textured_albedo(const Surface& surface, int surface_index, const Vec3d& point);

}  // namespace planescope::lab
