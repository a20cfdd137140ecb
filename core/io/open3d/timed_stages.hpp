#pragma once

// Stages of Open3D's that ours are timed beside, each with its input in Open3D's own types: what
// is returned runs the stage alone. Empty functions without -DPLANESCOPE_OPEN3D=ON.

#include <functional>
#include <span>

#include "core/planes/cloud/cloud.hpp"

namespace planescope::open3d {

/// VoxelDownSample of the cloud's kept points.
std::function<void()> voxel_down_sample(const planes::Cloud& cloud, double voxel_size_m);

/// An octree of pointers, with every node down to the cube's depth.
std::function<void()> pointer_octree(std::span<const Vec3f> points, const planes::Cube& cube);

}  // namespace planescope::open3d
