#pragma once

// Methods for comparison with ours; more are in core/lab/rivals.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

/// Result of a rival method: planes without labels and octree.
struct FoundPlanes {
  std::vector<std::int32_t> plane_of;  // per point: plane id from 1, 0 none
  std::vector<PlaneFit> planes;        // by id - 1, largest first; fitted to their points
};

/// Converts groups of points (ids > 0; other ids are ignored) with at least `min_points` to planes,
/// largest first, ties by id.
FoundPlanes found_planes(std::span<const Vec3f> points,
                         std::span<const std::int32_t> group,
                         int min_points = 1);

/// Throws Error for a rival that is not part of this build; `option` is the CMake option.
[[noreturn]] void refuse_absent_rival(const char* name, const char* option);

// First rival in the paper (Sec. V-C 1): RANSAC that repeatedly extracts the plane with
// most points.

struct RansacOptions {
  double theta_pf_m = 0.01;  // largest distance of an inlier; the paper also uses 0.02
  int iterations = 1000;     // maximum per plane
  int min_points = 50;       // smallest plane
  int seed = 1;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = RansacOptions;
    rows.number("ransac_theta_pf_m", "Inlier distance", "m", "RANSAC: inlier distance",
                &O::theta_pf_m, {0, 100, true});
    rows.number("ransac_iterations", "Iterations", "tries",
                "RANSAC: maximum number of iterations per plane", &O::iterations, {1, 1e6});
    rows.number("ransac_min_points", "Minimum points", "points",
                "RANSAC: minimum number of points in a plane", &O::min_points, {3, 1e9});
    rows.number("ransac_seed", "Random seed", "1", "RANSAC: random seed", &O::seed);
  }
};

/// Stops at the first plane with too few points. Implemented with Open3D: throws Error unless the
/// program called open3d::install().
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

using RansacFunction = FoundPlanes(std::span<const Vec3f>, const RansacOptions&);
void set_ransac(RansacFunction* function);  // call before using any method or option
bool has_ransac();

// Second rival in the paper (Sec. V-C 2): fits cells, and grows regions over the planar ones.
// Proenca & Gao, "Fast Cylinder and Plane Extraction from Depth Cameras for Visual Odometry" (IROS
// 2018), called CAPE below.

/// Our reading of the paper's two thresholds. 0.01 m^2 limits e_n, the smallest eigenvalue of the
/// scatter, of a full patch of 400 pixels, and other cells in proportion to their points. Planar
/// cells are thus 5 mm thick (RMS); in depth images beyond 1 m, 5 mm times depth squared, like
/// stereo noise. (As a limit on the mean square, 10 cm, all cells would be planar.) 0.86 is the
/// smallest cosine between merged regions, which must also satisfy the first limit together.
struct RegionGrowingOptions {
  int patch_px = 20;                  // edge of a cell of depth images
  double voxel_size_m = 0.05;         // edge of a cell of unordered clouds
  double region_threshold_m2 = 0.01;  // "threshold for planar region identification"
  double merge_threshold = 0.86;      // "threshold for plane merging"
  bool refine_boundaries = true;      // assign points along region borders individually
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = RegionGrowingOptions;
    rows.number("region_patch_px", "Image cell size", "px",
                "Region growing: cell edge in depth images", &O::patch_px, {2, 1000});
    rows.number("region_voxel_size_m", "Cloud cell size", "m",
                "Region growing: cell edge in unordered clouds", &O::voxel_size_m, {0, 100, true});
    rows.number("region_threshold_m2", "Planarity threshold", "m2",
                "Region growing: threshold for planar region identification",
                &O::region_threshold_m2);
    rows.number("region_merge_threshold", "Merge threshold", "1",
                "Region growing: minimum cosine between the normals of merged regions",
                &O::merge_threshold, {-1, 1});
    rows.flag("region_refine_boundaries", "Refine boundaries",
              "Region growing: refine points along the borders of regions", &O::refine_boundaries);
  }
};

/// Measurements on pixels of a depth image, in raster order.
struct PixelPoints {
  std::span<const Vec3f> points;         // [m], any frame
  std::span<const std::uint32_t> pixel;  // v * width + u of each point, ascending
  std::span<const std::uint8_t> kept;    // 0: cropped, ignored
  Vec3f sensor = Vec3f::Zero();          // camera position, in the points' frame
  Vec3f view = Vec3f::UnitZ();           // optical axis, in the points' frame
  int width = 0, height = 0;
};

/// Depth images: planar 20 x 20 px cells, seeds from a histogram of normals, growing over the grid
/// of cells, merging, and refinement of border pixels. plane_of is per point of `input`.
FoundPlanes grow_regions(const PixelPoints& input, const RegionGrowingOptions& options);

/// Unordered clouds: the same over the 26-neighborhood of voxels.
FoundPlanes grow_regions(std::span<const Vec3f> points, const RegionGrowingOptions& options);

}  // namespace planescope::planes
