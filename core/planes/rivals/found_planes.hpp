#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/plane.hpp"

namespace planescope::planes {

/// What a rival finds: planes alone. It knows neither h and v nor an octree.
struct FoundPlanes {
  std::vector<std::int32_t> plane_of;  // per point: plane id from 1, 0 none
  std::vector<PlaneFit> planes;        // by id - 1, largest first; fitted to the points they have
};

/// From points grouped under any ids > 0 (others: none): the groups that have `min_points` or more
/// become planes, of equally large ones the lower id first.
FoundPlanes found_planes(std::span<const Vec3f> points,
                         std::span<const std::int32_t> group,
                         int min_points = 1);

/// Throws the Error of a rival that this program was built without; `option` is CMake's.
[[noreturn]] void refuse_absent_rival(const char* name, const char* option);

}  // namespace planescope::planes
