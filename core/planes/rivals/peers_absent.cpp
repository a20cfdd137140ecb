// The peers in builds without -DPLANESCOPE_PEERS=ON.

#include "core/model/error.hpp"
#include "core/planes/rivals/peers.hpp"

namespace planescope::planes {
namespace {

[[noreturn]] void refuse(const char* name) {
  throw Error(std::string("method ") + name +
              " is not part of this build, configure it with -DPLANESCOPE_PEERS=ON");
}

}  // namespace

bool has_peers() { return false; }

FoundPlanes pcl_multi_plane(const PixelPoints&, const PclMultiPlaneOptions&) {
  refuse("pcl-multi-plane");
}
FoundPlanes pcl_region_growing(std::span<const Vec3f>, const PclRegionGrowingOptions&) {
  refuse("pcl-region-growing");
}
FoundPlanes cgal_ransac(std::span<const Vec3f>, const CgalRansacOptions&) { refuse("cgal-ransac"); }
FoundPlanes cgal_region_growing(std::span<const Vec3f>, const CgalRegionGrowingOptions&) {
  refuse("cgal-region-growing");
}

}  // namespace planescope::planes
