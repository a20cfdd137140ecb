#pragma once

#include <array>
#include <cstdint>

#include "core/synthetic/ray_cast.hpp"

namespace planescope {

/// Linear RGB of a point on a surface: its texture under a lamp that casts shadows, sky light and
/// light thrown back by the ground.
Vec3d shade(const Scene& scene, const CastScene& cast, int surface, const Vec3d& point);

/// Linear light to 8-bit display values (gamma 2: exact square roots).
std::array<std::uint8_t, 3> to_display(const Vec3d& linear);

}  // namespace planescope
