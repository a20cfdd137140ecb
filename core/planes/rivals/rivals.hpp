#pragma once

// The methods that ours is compared with.

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

// The rivals of PCL and CGAL, as Debian packages them. Built with -DPLANESCOPE_RIVALS=ON alone; in
// other builds every function here throws Error saying so.
//
// Options are tuned, by mean IoU and panoptic quality (docs/method.md, "Further rivals"): defaults
// on depth images and their 2 cm voxels, k...ByPoint on the paper's stairs of 8192 points.

/// Whether this build has them.
bool has_pcl_and_cgal();

struct PclMultiPlaneOptions {
  int normal_px = 20;        // edge of the square that a pixel's normal is computed from
  double depth_step = 0.02;  // no normal across a larger change of depth, as a part of the depth
  int min_points = 300;      // of a plane, before refinement
  double angle_deg = 2.5;    // between neighbours' normals
  double distance_m = 0.02;  // between neighbours' plane offsets, at a depth of 1 m
  double curvature = 0.03;   // of a region, at most: least eigenvalue / sum of all
  double refine_distance_m = 0.01;  // of a pixel that joins a plane beside it
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = PclMultiPlaneOptions;
    rows.number("pcl_multi_plane_normal_px", "Window of normals", "px",
                "PCL multi-plane: edge of the square that a pixel's normal is computed from",
                &O::normal_px, {2, 1000});
    rows.number("pcl_multi_plane_depth_step", "Largest depth step", "share",
                "PCL multi-plane: no normal across a larger change of depth", &O::depth_step,
                {0, 1, true});
    rows.number("pcl_multi_plane_min_points", "Fewest points", "points",
                "PCL multi-plane: a plane has at least", &O::min_points, {3, 1e9});
    rows.number("pcl_multi_plane_angle_deg", "Angle between normals", "deg",
                "PCL multi-plane: between neighbours' normals", &O::angle_deg, {0, 180});
    rows.number("pcl_multi_plane_distance_m", "Distance between planes", "m",
                "PCL multi-plane: between neighbours' plane offsets, at a depth of 1 m",
                &O::distance_m, {0, 100, true});
    rows.number("pcl_multi_plane_curvature", "Largest curvature", "1",
                "PCL multi-plane: of a region, at most", &O::curvature, {0, 1});
    rows.number("pcl_multi_plane_refine_distance_m", "Refinement distance", "m",
                "PCL multi-plane: of a pixel that joins a plane beside it", &O::refine_distance_m,
                {0, 100, true});
  }
};
/// PCL OrganizedMultiPlaneSegmentation (Trevor et al. 2013) with its refinement, on normals from
/// integral images (Holzer et al. 2012): for depth images.
FoundPlanes pcl_multi_plane(const PixelPoints& input, const PclMultiPlaneOptions& options);

struct PclRegionGrowingOptions {
  int normal_neighbours = 20;
  int neighbours = 30;
  double smoothness_deg = 12;  // between the normals of neighbours
  double curvature = 0.08;     // where there is more, a region goes no further
  int min_points = 40;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = PclRegionGrowingOptions;
    rows.number("pcl_region_normal_neighbours", "Neighbors of normals", "points",
                "PCL region growing: nearest points that a normal is computed from",
                &O::normal_neighbours, {3, 1000});
    rows.number("pcl_region_neighbours", "Neighbors", "points",
                "PCL region growing: nearest points looked at", &O::neighbours, {3, 1000});
    rows.number("pcl_region_smoothness_deg", "Angle between normals", "deg",
                "PCL region growing: between neighbours' normals", &O::smoothness_deg, {0, 180});
    rows.number("pcl_region_curvature", "Largest curvature", "1",
                "PCL region growing: where there is more, a region goes no further", &O::curvature,
                {0, 1});
    rows.number("pcl_region_min_points", "Fewest points", "points",
                "PCL region growing: a plane has at least", &O::min_points, {3, 1e9});
  }
};
inline constexpr PclRegionGrowingOptions kPclRegionGrowingByPoint = {
    .normal_neighbours = 12, .smoothness_deg = 17, .curvature = 0.05, .min_points = 100};
/// PCL RegionGrowing (Rabbani et al. 2006).
FoundPlanes pcl_region_growing(std::span<const Vec3f> points,
                               const PclRegionGrowingOptions& options);

struct CgalRansacOptions {
  int normal_neighbours = 12;
  double epsilon_m = 0.01;         // between a point and its plane
  double cluster_epsilon_m = 0.1;  // between neighbours on a plane
  double normal_cosine = 0.75;     // between the normals of a point and its plane
  int min_points = 30;
  double probability = 0.001;  // of missing the largest plane
  int seed = 1;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = CgalRansacOptions;
    rows.number("cgal_ransac_normal_neighbours", "Neighbors of normals", "points",
                "CGAL RANSAC: nearest points that a normal is computed from", &O::normal_neighbours,
                {3, 1000});
    rows.number("cgal_ransac_epsilon_m", "Inlier distance", "m",
                "CGAL RANSAC: a point this near is on the plane", &O::epsilon_m, {0, 100, true});
    rows.number("cgal_ransac_cluster_epsilon_m", "Distance between neighbors", "m",
                "CGAL RANSAC: points this near are connected", &O::cluster_epsilon_m,
                {0, 100, true});
    rows.number("cgal_ransac_normal_cosine", "Cosine of normals", "1",
                "CGAL RANSAC: least cosine between a point's normal and the plane's",
                &O::normal_cosine, {0, 1});
    rows.number("cgal_ransac_min_points", "Fewest points", "points",
                "CGAL RANSAC: a plane has at least", &O::min_points, {3, 1e9});
    rows.number("cgal_ransac_probability", "Chance of missing a plane", "share",
                "CGAL RANSAC: of missing the largest plane", &O::probability, {0, 1, true});
    rows.number("cgal_ransac_seed", "Random seed", "1", "CGAL RANSAC: random seed", &O::seed);
  }
};
inline constexpr CgalRansacOptions kCgalRansacByPoint = {
    .epsilon_m = 0.008, .cluster_epsilon_m = 0.05, .min_points = 200};
/// CGAL Efficient RANSAC (Schnabel et al. 2007).
FoundPlanes cgal_ransac(std::span<const Vec3f> points, const CgalRansacOptions& options);

struct CgalRegionGrowingOptions {
  int normal_neighbours = 20;
  int neighbours = 12;
  double distance_m = 0.015;  // between a point and its plane
  double angle_deg = 42;      // between the normals of a point and its plane
  int min_points = 30;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = CgalRegionGrowingOptions;
    rows.number("cgal_region_normal_neighbours", "Neighbors of normals", "points",
                "CGAL region growing: nearest points that a normal is computed from",
                &O::normal_neighbours, {3, 1000});
    rows.number("cgal_region_neighbours", "Neighbors", "points",
                "CGAL region growing: nearest points looked at", &O::neighbours, {3, 1000});
    rows.number("cgal_region_distance_m", "Inlier distance", "m",
                "CGAL region growing: of a point from the plane", &O::distance_m, {0, 100, true});
    rows.number("cgal_region_angle_deg", "Angle to the plane", "deg",
                "CGAL region growing: between a point's normal and the plane's", &O::angle_deg,
                {0, 180});
    rows.number("cgal_region_min_points", "Fewest points", "points",
                "CGAL region growing: a plane has at least", &O::min_points, {3, 1e9});
  }
};
inline constexpr CgalRegionGrowingOptions kCgalRegionGrowingByPoint = {
    .distance_m = 0.012, .angle_deg = 45, .min_points = 100};
/// CGAL region growing on point sets (Lafarge & Mallet 2012).
FoundPlanes cgal_region_growing(std::span<const Vec3f> points,
                                const CgalRegionGrowingOptions& options);

}  // namespace planescope::planes
