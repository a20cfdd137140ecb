#include "core/planes/rivals/ransac.hpp"

namespace planescope::planes {
namespace {

RansacFunction* ransac = nullptr;

}  // namespace

FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options) {
  if (!ransac) refuse_absent_rival("ransac", "PLANESCOPE_OPEN3D");
  return ransac(points, options);
}

void set_ransac(RansacFunction* function) { ransac = function; }
bool has_ransac() { return ransac != nullptr; }

}  // namespace planescope::planes
