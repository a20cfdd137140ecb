#pragma once

// Which points of a plane hang together: shared by the split and by whoever replays it.

#include <cstdint>
#include <span>
#include <vector>

#include "core/segment/cells.hpp"
#include "core/segment/options.hpp"

namespace planescope {

/// Cells of about split_cell_m: points in touching cells are taken to touch.
CellGrid make_split_grid(const Octree& octree, const SegmentOptions& options);

/// Per cell the part of the plane that it holds, 0 for the part of the first cell; -1 where it
/// holds none of it.
struct PlaneParts {
  std::vector<std::int32_t> of_cell;
  std::int32_t count = 0;
};
PlaneParts connected_parts(const CellGrid& grid,
                           std::span<const std::int32_t> plane_of,
                           std::int32_t plane);

}  // namespace planescope
