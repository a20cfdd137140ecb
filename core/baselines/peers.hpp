#pragma once

// Further peers, from libraries that Debian packages. Built with -DPLANESCOPE_PEERS=ON alone; in
// other builds every function here throws Error saying so.

#include <span>

#include "core/baselines/found_planes.hpp"
#include "core/baselines/region_growing.hpp"
#include "core/geometry/types.hpp"

namespace planescope {

/// Whether this build has them.
bool has_peers();

struct PclMultiPlaneOptions {
  int normal_px = 20;        // edge of the square that a pixel's normal is computed from
  double depth_step = 0.02;  // no normal across a larger change of depth, as a part of the depth
  int min_points = 100;      // of a plane, before refinement
  double angle_deg = 3;      // between neighbours' normals
  double distance_m = 0.02;  // between neighbours' plane offsets, at a depth of 1 m
  double curvature = 0.001;  // of a region, at most: least eigenvalue / sum of all
  double refine_distance_m = 0.02;  // of a pixel that joins a plane beside it
};
/// PCL OrganizedMultiPlaneSegmentation (Trevor et al. 2013) with its refinement, on normals from
/// integral images (Holzer et al. 2012): for depth images.
FoundPlanes pcl_multi_plane(const PixelPoints& input, const PclMultiPlaneOptions& options);

struct PclRegionGrowingOptions {
  int normal_neighbours = 30;
  int neighbours = 30;
  double smoothness_deg = 5;  // between the normals of neighbours
  double curvature = 0.05;    // where there is more, a region goes no further
  int min_points = 20;
};
/// PCL RegionGrowing (Rabbani et al. 2006).
FoundPlanes pcl_region_growing(std::span<const Vec3f> points,
                               const PclRegionGrowingOptions& options);

struct CgalRansacOptions {
  int normal_neighbours = 12;
  double epsilon_m = 0.01;          // between a point and its plane
  double cluster_epsilon_m = 0.05;  // between neighbours on a plane
  double normal_cosine = 0.9;       // between the normals of a point and its plane
  int min_points = 20;
  double probability = 0.01;  // of missing the largest plane
  int seed = 1;
};
/// CGAL Efficient RANSAC (Schnabel et al. 2007).
FoundPlanes cgal_ransac(std::span<const Vec3f> points, const CgalRansacOptions& options);

struct CgalRegionGrowingOptions {
  int normal_neighbours = 12;
  int neighbours = 12;
  double distance_m = 0.01;  // between a point and its plane
  double angle_deg = 25;     // between the normals of a point and its plane
  int min_points = 20;
};
/// CGAL region growing on point sets (Lafarge & Mallet 2012).
FoundPlanes cgal_region_growing(std::span<const Vec3f> points,
                                const CgalRegionGrowingOptions& options);

}  // namespace planescope
