// Builds without -DPLANESCOPE_OPEN3D=ON.

#include "core/io/open3d/install.hpp"
#include "core/io/open3d/timed_stages.hpp"

namespace planescope::open3d {

void install() {}

std::function<void()> voxel_down_sample(const planes::Cloud&, double) { return {}; }
std::function<void()> pointer_octree(std::span<const Vec3f>, const planes::Cube&) { return {}; }

}  // namespace planescope::open3d
