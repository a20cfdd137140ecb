#pragma once

// The oracle as a method: scored like all others.

#include <span>

#include "core/lab/synthetic/oracle.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// Every voxel to the nearest of the polygons (in the frame's own coordinates), planes fitted to
/// their voxels by least squares.
planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons);

}  // namespace planescope::lab
