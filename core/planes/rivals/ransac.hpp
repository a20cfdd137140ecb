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

/// Ends with the first plane that has too few points. Open3D does it, and only programs that link
/// core/io/open3d have that: its install() hands it over. Throws Error where nobody did.
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

using RansacFunction = FoundPlanes(std::span<const Vec3f>, const RansacOptions&);
void set_ransac(RansacFunction* function);  // before any method or option is asked for
bool has_ransac();

}  // namespace planescope::planes
