#pragma once

// What a click on a floor or on a wall says of gravity. Normals are unit and face the sensor; all
// is in the sensor's (or cloud's own) frame.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

/// Things fall against the normal of a floor that is seen from above.
Vec3d gravity_of_floor(const Vec3d& normal);

/// Walls stand upright: gravity is perpendicular to all their normals. One wall leaves an angle
/// open, which `before` closes: the direction known so far, or the camera's own. Several are taken
/// by least squares, and `before` only tells up from down. nullopt, with a phrase why, where the
/// wall lies level by what is known, or all walls are parallel.
std::optional<Vec3d> gravity_of_walls(std::span<const Vec3d> normals,
                                      const Vec3d& before,
                                      std::string* why_not = nullptr);

}  // namespace planescope::planes
