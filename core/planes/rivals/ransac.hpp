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
};

/// Ends with the first plane that has too few points. Runs in Open3D: only programs that call
/// open3d::install() have it, others get an Error.
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

using RansacFunction = FoundPlanes(std::span<const Vec3f>, const RansacOptions&);
void set_ransac(RansacFunction* function);  // before any method or option is asked for
bool has_ransac();

}  // namespace planescope::planes
