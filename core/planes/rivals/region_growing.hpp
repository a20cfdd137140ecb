#pragma once

// The paper's second rival (Sec. V-C 2): cells are fitted, those that are planar grow together.
// Proenca & Gao, "Fast Cylinder and Plane Extraction from Depth Cameras for Visual Odometry"
// (IROS 2018), CAPE below.

#include <cstdint>
#include <span>

#include "core/model/types.hpp"
#include "core/planes/rivals/found_planes.hpp"

namespace planescope::planes {

/// How the paper's two thresholds are read. 0.01 m^2 bounds e_n, the scatter's smallest eigenvalue,
/// of a full patch of 400 pixels, other cells in proportion to their points: planar cells are 5 mm
/// thick (RMS), in depth images beyond 1 m 5 mm times depth squared, as stereo noise grows. (As the
/// mean square itself, 10 cm, all would be planar.) 0.86 is the cosine between regions that may
/// merge, and do where the same bound holds for their union.
struct RegionGrowingOptions {
  int patch_px = 20;                  // edge of a cell of depth images
  double voxel_size_m = 0.05;         // edge of a cell of unordered clouds
  double region_threshold_m2 = 0.01;  // "threshold for planar region identification"
  double merge_threshold = 0.86;      // "threshold for plane merging"
  bool refine_boundaries = true;      // points along a region's border are looked at singly
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = RegionGrowingOptions;
    rows.number("region_patch_px", "Cell of images", "px", "Region growing: cell edge in depth images", &O::patch_px, {2, 1000});
    rows.number("region_voxel_size_m", "Cell of clouds", "m", "Region growing: cell edge in unordered clouds", &O::voxel_size_m, {0, 100, true});
    rows.number("region_threshold_m2", "Planarity threshold", "m2", "Region growing: threshold of planar region identification", &O::region_threshold_m2);
    rows.number("region_merge_threshold", "Merge threshold", "1", "Region growing: smallest cosine between the normals of merged regions", &O::merge_threshold, {-1, 1});
    rows.flag("region_refine_boundaries", "Refine boundaries", "Region growing: refine points along the borders of regions", &O::refine_boundaries);
  }
};

/// Measurements on the pixels of a depth image, in raster order.
struct PixelPoints {
  std::span<const Vec3f> points;         // [m], any frame
  std::span<const std::uint32_t> pixel;  // v * width + u of each point, ascending
  std::span<const std::uint8_t> kept;    // 0: cropped, takes no part
  Vec3f sensor = Vec3f::Zero();          // where the camera stands, in the points' frame
  Vec3f view = Vec3f::UnitZ();           // its optical axis, in the points' frame
  int width = 0, height = 0;
};

/// On depth images: planar 20 x 20 px cells, seeds from a histogram of their normals, growth over
/// the grid of cells, merging, and the pixels along the borders. plane_of is per point of `input`.
FoundPlanes grow_regions(const PixelPoints& input, const RegionGrowingOptions& options);

/// On unordered clouds: the same over the 26-neighbourhood of voxels.
FoundPlanes grow_regions(std::span<const Vec3f> points, const RegionGrowingOptions& options);

}  // namespace planescope::planes
