// The rivals of PCL and CGAL in builds without -DPLANESCOPE_RIVALS=ON.

#include "core/planes/rivals/rivals.hpp"

namespace planescope::planes {
namespace {

[[noreturn]] void refuse(const char* name) { refuse_absent_rival(name, "PLANESCOPE_RIVALS"); }

}  // namespace

bool has_pcl_and_cgal() { return false; }

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
