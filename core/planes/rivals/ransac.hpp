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

/// Open3D's SegmentPlane, under one thread and the seed so that it repeats; calls wait for each
/// other, since Open3D has one random sequence for the whole process. Ends with the first plane
/// that has too few points.
FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options);

}  // namespace planescope::planes
