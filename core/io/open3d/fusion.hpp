#pragma once

#include "core/io/surface_fusion.hpp"

namespace planescope::open3d {

/// Open3D's ScalableTSDFVolume, truncated at four voxels. Its camera has no lens distortion: add()
/// throws Error where ours has some.
std::unique_ptr<io::SurfaceFusion> make_fusion(double voxel_m, double max_range_m);

}  // namespace planescope::open3d
