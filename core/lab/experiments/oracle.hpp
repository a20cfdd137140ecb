#pragma once

// The best that geometry alone can do: each point to its nearest true plane, where that plane ends
// as the generator made it.

#include <cstdint>
#include <span>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/model/types.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// Distance from a point to the nearest point of the polygon [m].
double distance_m(const TruePolygon& polygon, const Vec3d& point);

/// Per point the plane of the polygon that is nearest to it (of equally near ones the first), 0
/// where that is something curved.
std::vector<std::int32_t> oracle_planes(std::span<const Vec3f> points,
                                        std::span<const TruePolygon> polygons);

/// The oracle as a method, to be scored like all others: every voxel to the nearest of the polygons
/// (in the frame's own coordinates), planes fitted to their voxels by least squares.
planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons);

}  // namespace planescope::lab
