#pragma once

// The paper's first rival (Sec. V-C 1): the plane with most points is taken away, again and again.

#include <span>

#include "core/model/types.hpp"
#include "core/planes/rivals/found_planes.hpp"

namespace planescope::planes {

struct RansacOptions {
  double theta_pf_m =
      0.01;               // a point within this distance is on the plane; the paper's other: 0.02
  int iterations = 1000;  // at most, for each plane
  int min_points = 50;    // a plane has at least so many
  int seed = 1;
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = RansacOptions;
    rows.number("ransac_theta_pf_m", "Inlier distance", "m", "RANSAC: inlier distance", &O::theta_pf_m, {0, 100, true});
    rows.number("ransac_iterations", "Iterations", "tries", "RANSAC: most iterations per plane", &O::iterations, {1, 1e6});
    rows.number("ransac_min_points", "Fewest points", "points", "RANSAC: fewest points of a plane", &O::min_points, {3, 1e9});
    rows.number("ransac_seed", "Random seed", "1", "RANSAC: random seed", &O::seed);
  }
};

/// Ends with the first plane that has too few points. Runs in Open3D: only programs that call
/// open3d::install() have it, others get an Error.
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

using RansacFunction = FoundPlanes(std::span<const Vec3f>, const RansacOptions&);
void set_ransac(RansacFunction* function);  // before any method or option is asked for
bool has_ransac();

}  // namespace planescope::planes
