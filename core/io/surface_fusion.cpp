#include "core/io/surface_fusion.hpp"

#include "core/model/error.hpp"

namespace planescope::io {
namespace {

SurfaceFusionMaker* installed = nullptr;

}  // namespace

std::unique_ptr<SurfaceFusion> make_surface_fusion(double voxel_m, double max_range_m) {
  if (!installed) throw Error("meshes: this program was built without Open3D, which makes them");
  return installed(voxel_m, max_range_m);
}

void set_surface_fusion(SurfaceFusionMaker* make) { installed = make; }

}  // namespace planescope::io
