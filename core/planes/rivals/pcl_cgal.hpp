#pragma once

// The rivals of PCL and CGAL, as Debian packages them. Built with -DPLANESCOPE_RIVALS=ON alone; in
// other builds every function here throws Error saying so.
//
// Options are tuned, by mean IoU and panoptic quality (docs/method.md, "Further rivals"): defaults
// on depth images and their 2 cm voxels, k...ByPoint on the paper's stairs of 8192 points.

#include <span>

#include "core/model/types.hpp"
#include "core/planes/rivals/found_planes.hpp"
#include "core/planes/rivals/region_growing.hpp"

namespace planescope::planes {

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
    rows.number("pcl_multi_plane_normal_px", "Window of normals", "px", "PCL multi-plane: edge of the square that a pixel's normal is computed from", &O::normal_px, {2, 1000});
    rows.number("pcl_multi_plane_depth_step", "Largest depth step", "share", "PCL multi-plane: no normal across a larger change of depth", &O::depth_step, {0, 1, true});
    rows.number("pcl_multi_plane_min_points", "Fewest points", "points", "PCL multi-plane: a plane has at least", &O::min_points, {3, 1e9});
    rows.number("pcl_multi_plane_angle_deg", "Angle between normals", "deg", "PCL multi-plane: between neighbours' normals", &O::angle_deg, {0, 180});
    rows.number("pcl_multi_plane_distance_m", "Distance between planes", "m", "PCL multi-plane: between neighbours' plane offsets, at a depth of 1 m", &O::distance_m, {0, 100, true});
    rows.number("pcl_multi_plane_curvature", "Largest curvature", "1", "PCL multi-plane: of a region, at most", &O::curvature, {0, 1});
    rows.number("pcl_multi_plane_refine_distance_m", "Refinement distance", "m", "PCL multi-plane: of a pixel that joins a plane beside it", &O::refine_distance_m, {0, 100, true});
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
    rows.number("pcl_region_normal_neighbours", "Neighbors of normals", "points", "PCL region growing: nearest points that a normal is computed from", &O::normal_neighbours, {3, 1000});
    rows.number("pcl_region_neighbours", "Neighbors", "points", "PCL region growing: nearest points looked at", &O::neighbours, {3, 1000});
    rows.number("pcl_region_smoothness_deg", "Angle between normals", "deg", "PCL region growing: between neighbours' normals", &O::smoothness_deg, {0, 180});
    rows.number("pcl_region_curvature", "Largest curvature", "1", "PCL region growing: where there is more, a region goes no further", &O::curvature, {0, 1});
    rows.number("pcl_region_min_points", "Fewest points", "points", "PCL region growing: a plane has at least", &O::min_points, {3, 1e9});
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
    rows.number("cgal_ransac_normal_neighbours", "Neighbors of normals", "points", "CGAL RANSAC: nearest points that a normal is computed from", &O::normal_neighbours, {3, 1000});
    rows.number("cgal_ransac_epsilon_m", "Inlier distance", "m", "CGAL RANSAC: a point this near is on the plane", &O::epsilon_m, {0, 100, true});
    rows.number("cgal_ransac_cluster_epsilon_m", "Distance between neighbors", "m", "CGAL RANSAC: points this near are connected", &O::cluster_epsilon_m, {0, 100, true});
    rows.number("cgal_ransac_normal_cosine", "Cosine of normals", "1", "CGAL RANSAC: least cosine between a point's normal and the plane's", &O::normal_cosine, {0, 1});
    rows.number("cgal_ransac_min_points", "Fewest points", "points", "CGAL RANSAC: a plane has at least", &O::min_points, {3, 1e9});
    rows.number("cgal_ransac_probability", "Chance of missing a plane", "share", "CGAL RANSAC: of missing the largest plane", &O::probability, {0, 1, true});
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
    rows.number("cgal_region_normal_neighbours", "Neighbors of normals", "points", "CGAL region growing: nearest points that a normal is computed from", &O::normal_neighbours, {3, 1000});
    rows.number("cgal_region_neighbours", "Neighbors", "points", "CGAL region growing: nearest points looked at", &O::neighbours, {3, 1000});
    rows.number("cgal_region_distance_m", "Inlier distance", "m", "CGAL region growing: of a point from the plane", &O::distance_m, {0, 100, true});
    rows.number("cgal_region_angle_deg", "Angle to the plane", "deg", "CGAL region growing: between a point's normal and the plane's", &O::angle_deg, {0, 180});
    rows.number("cgal_region_min_points", "Fewest points", "points", "CGAL region growing: a plane has at least", &O::min_points, {3, 1e9});
  }
};
inline constexpr CgalRegionGrowingOptions kCgalRegionGrowingByPoint = {
    .distance_m = 0.012, .angle_deg = 45, .min_points = 100};
/// CGAL region growing on point sets (Lafarge & Mallet 2012).
FoundPlanes cgal_region_growing(std::span<const Vec3f> points,
                                const CgalRegionGrowingOptions& options);

}  // namespace planescope::planes
