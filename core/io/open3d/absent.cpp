// Builds without -DPLANESCOPE_OPEN3D=ON.

#include "core/io/open3d/install.hpp"
#include "core/model/error.hpp"

namespace planescope::open3d {

void install() {}

std::unique_ptr<SurfaceFusion> make_surface_fusion(double, double) {
  throw Error("meshes require Open3D, but this program was built without it");
}

std::function<void()> voxel_down_sample(const planes::Cloud&, double) { return {}; }
std::function<void()> pointer_octree(std::span<const Vec3f>, const planes::Cube&) { return {}; }

}  // namespace planescope::open3d
