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
  int min_points = 100;
  double angle_deg = 3;      // between neighbours' normals
  double distance_m = 0.02;  // between neighbours' plane offsets
};
/// PCL OrganizedMultiPlaneSegmentation (Trevor et al. 2013), for depth images.
FoundPlanes pcl_multi_plane(const PixelPoints& input, const PclMultiPlaneOptions& options);

struct PclRegionGrowingOptions {
  int neighbours = 30;
  double smoothness_deg = 5;
  double curvature = 0.05;
  int min_points = 20;
};
/// PCL RegionGrowing (Rabbani et al. 2006).
FoundPlanes pcl_region_growing(std::span<const Vec3f> points,
                               const PclRegionGrowingOptions& options);

struct CgalRansacOptions {
  double epsilon_m = 0.01;
  double cluster_epsilon_m = 0.05;
  double normal_cosine = 0.9;
  int min_points = 20;
  double probability = 0.01;  // of missing the largest plane
};
/// CGAL Efficient RANSAC (Schnabel et al. 2007).
FoundPlanes cgal_ransac(std::span<const Vec3f> points, const CgalRansacOptions& options);

struct CgalRegionGrowingOptions {
  int neighbours = 12;
  double distance_m = 0.01;
  double angle_deg = 25;
  int min_points = 20;
};
/// CGAL region growing on point sets (Lafarge & Mallet 2012).
FoundPlanes cgal_region_growing(std::span<const Vec3f> points,
                                const CgalRegionGrowingOptions& options);

}  // namespace planescope
