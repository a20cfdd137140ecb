#pragma once

#include <span>

#include "core/planes/rivals/rivals.hpp"

namespace planescope::open3d {

/// Open3D's SegmentPlane, under one thread and the seed so that it repeats; calls wait for each
/// other, since Open3D has one random sequence for the whole process. Ends with the first plane
/// that has too few points.
planes::FoundPlanes find_planes_ransac(std::span<const Vec3f> points,
                                       const planes::RansacOptions& options);

}  // namespace planescope::open3d
