#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/plane.hpp"

namespace planescope {

/// What a rival finds: planes alone. It knows neither h and v nor an octree.
struct FoundPlanes {
  std::vector<std::int32_t> plane_of;  // per point: plane id from 1, 0 none
  std::vector<PlaneFit> planes;        // by id - 1, largest first; fitted to the points they have
};

}  // namespace planescope
