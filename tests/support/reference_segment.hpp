#pragma once

// A second implementation of the paper's method, as simple as possible: a pointer octree built by
// inserting points one by one, with the set of points in every node (Sun et al. 2023, Sec. IV-A),
// every covariance computed from points in two passes, and lists instead of sorted arrays. It
// shares only the options with core/planes/segment, which must agree with it point by point and is
// compared with it in benchmarks.

#include <span>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::reference {

struct Plane {
  Label label;
  PlaneFit fit;
};

struct Result {
  std::vector<int> plane_of;  // per input point: index into planes, -1 none
  std::vector<Plane> planes;  // remaining planes, in order of founding
};

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const planes::Cube& cube,
               const planes::SegmentOptions& options);

}  // namespace planescope::reference
