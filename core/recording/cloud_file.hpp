#pragma once

#include <filesystem>
#include <span>

#include "core/recording/frame.hpp"

namespace planescope {

/// Reads a .ply or .pcd cloud with its colours and its `label` / `instance` fields (any integer
/// type). The header is checked against the file's size before anything is allocated.
PointSet read_cloud_file(const std::filesystem::path& path);

/// Writes binary little-endian PLY: float x y z (double when set.origin is not zero), then
/// uchar red green blue where set.rgb is given, uchar label and int instance where given.
void write_ply(const std::filesystem::path& path, const PointSet& set);

}  // namespace planescope
