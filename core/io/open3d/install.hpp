#pragma once

namespace planescope::open3d {

/// Hands over what Open3D does for the program: the rival `ransac` (core/planes/rivals/rivals.hpp),
/// meshes (core/io/surface_fusion.hpp) and the cloud formats .xyz, .pts, .obj, .stl and .off
/// (core/io/cloud_files/cloud_file.hpp). To be called once, before any recording, method or option
/// is asked for. Without -DPLANESCOPE_OPEN3D=ON there is nothing to hand over.
void install();

}  // namespace planescope::open3d
