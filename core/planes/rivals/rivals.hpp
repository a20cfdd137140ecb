#pragma once

// The methods that ours is compared with; core/lab/rivals has more.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

/// What a rival finds: planes alone. It knows neither h and v nor an octree.
struct FoundPlanes {
  std::vector<std::int32_t> plane_of;  // per point: plane id from 1, 0 none
  std::vector<PlaneFit> planes;        // by id - 1, largest first; fitted to the points they have
};

/// From points grouped under any ids > 0 (others: none): the groups that have `min_points` or more
/// become planes, of equally large ones the lower id first.
FoundPlanes found_planes(std::span<const Vec3f> points,
                         std::span<const std::int32_t> group,
                         int min_points = 1);

/// Throws the Error of a rival that this program was built without; `option` is CMake's.
[[noreturn]] void refuse_absent_rival(const char* name, const char* option);

// The paper's first rival (Sec. V-C 1): the plane with most points is taken away, again and again.

struct RansacOptions {
  double theta_pf_m =
      0.01;               // a point within this distance is on the plane; the paper's other: 0.02
  int iterations = 1000;  // at most, for each plane
  int min_points = 50;    // a plane has at least so many
  int seed = 1;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = RansacOptions;
    rows.number("ransac_theta_pf_m", "Inlier distance", "m", "RANSAC: inlier distance",
                &O::theta_pf_m, {0, 100, true});
    rows.number("ransac_iterations", "Iterations", "tries", "RANSAC: most iterations per plane",
                &O::iterations, {1, 1e6});
    rows.number("ransac_min_points", "Fewest points", "points", "RANSAC: fewest points of a plane",
                &O::min_points, {3, 1e9});
    rows.number("ransac_seed", "Random seed", "1", "RANSAC: random seed", &O::seed);
  }
};

/// Ends with the first plane that has too few points. Runs in Open3D: only programs that call
/// open3d::install() have it, others get an Error.
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

using RansacFunction = FoundPlanes(std::span<const Vec3f>, const RansacOptions&);
void set_ransac(RansacFunction* function);  // before any method or option is asked for
bool has_ransac();

// The paper's second rival (Sec. V-C 2): cells are fitted, those that are planar grow together.
// Proenca & Gao, "Fast Cylinder and Plane Extraction from Depth Cameras for Visual Odometry"
// (IROS 2018), CAPE below.

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
    rows.number("region_patch_px", "Cell of images", "px",
                "Region growing: cell edge in depth images", &O::patch_px, {2, 1000});
    rows.number("region_voxel_size_m", "Cell of clouds", "m",
                "Region growing: cell edge in unordered clouds", &O::voxel_size_m, {0, 100, true});
    rows.number("region_threshold_m2", "Planarity threshold", "m2",
                "Region growing: threshold of planar region identification",
                &O::region_threshold_m2);
    rows.number("region_merge_threshold", "Merge threshold", "1",
                "Region growing: smallest cosine between the normals of merged regions",
                &O::merge_threshold, {-1, 1});
    rows.flag("region_refine_boundaries", "Refine boundaries",
              "Region growing: refine points along the borders of regions", &O::refine_boundaries);
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
