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
};
inline constexpr CgalRegionGrowingOptions kCgalRegionGrowingByPoint = {
    .distance_m = 0.012, .angle_deg = 45, .min_points = 100};
/// CGAL region growing on point sets (Lafarge & Mallet 2012).
FoundPlanes cgal_region_growing(std::span<const Vec3f> points,
                                const CgalRegionGrowingOptions& options);

}  // namespace planescope::planes
