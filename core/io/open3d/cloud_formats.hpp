#pragma once

#include <filesystem>

#include "core/model/frame.hpp"

namespace planescope::open3d {

// Files that Open3D reads and io does not. Both throw Error naming the file where there is nothing
// in it that can be read.

/// .xyz: x y z on every line. .pts: a count, then x y z, intensity and colour on every line.
PointSet read_points(const std::filesystem::path& path);

/// .obj, .stl, .off: a mesh in metres as points on its triangles, one per square centimetre (at
/// least 10 000, at most two million), with the vertices' colours. The same file gives the same
/// points.
PointSet read_mesh(const std::filesystem::path& path);

}  // namespace planescope::open3d
