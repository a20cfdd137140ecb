#pragma once

#include <array>
#include <cstdint>

#include "core/lab/synthetic/ray_cast.hpp"

namespace planescope::lab {

/// Ambient occlusion: the share of light from all around that reaches a point on a surface, 0..1,
/// less beside surfaces that rise above it.
double openness(const Scene& scene, const CastScene& cast, int surface, const Vec3d& point);

/// Linear RGB of a point on a surface: its texture under a lamp that casts shadows, and under the
/// light of the sky and the ground as far as the point is open to it.
Vec3d shade(
    const Scene& scene, const CastScene& cast, int surface, const Vec3d& point, double open);

/// Linear light to 8-bit display values (gamma 2: exact square roots).
std::array<std::uint8_t, 3> to_display(const Vec3d& linear);

}  // namespace planescope::lab
