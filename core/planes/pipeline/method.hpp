#pragma once

// What finds the planes: ours, or one of the rivals that ours is compared with.

#include <cstdint>
#include <string>
#include <vector>

#include "core/planes/rivals/pcl_cgal.hpp"
#include "core/planes/rivals/ransac.hpp"
#include "core/planes/rivals/region_growing.hpp"

namespace planescope::planes {

enum class Method : std::uint8_t {
  ours,
  ransac,  // the paper's rivals; this one only in programs that have Open3D (has_ransac())
  region_growing,
  pcl_multi_plane,  // further rivals, only where they were built (has_pcl_and_cgal())
  pcl_region_growing,
  cgal_ransac,
  cgal_region_growing,
};
/// As --method has it: "region-growing".
const char* to_string(Method method);
Method parse_method(const std::string& text);  // throws Error naming those that this build has
const std::vector<Method>& all_methods();      // ours first, built or not
const std::vector<Method>& built_methods();    // ours first; the same for the whole process

/// Options of all methods but ours, which has SegmentOptions.
struct RivalOptions {
  RansacOptions ransac;
  RegionGrowingOptions region_growing;
  PclMultiPlaneOptions pcl_multi_plane;
  PclRegionGrowingOptions pcl_region_growing;
  CgalRansacOptions cgal_ransac;
  CgalRegionGrowingOptions cgal_region_growing;
};

}  // namespace planescope::planes
