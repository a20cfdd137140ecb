#pragma once

// The method of the paper once more, as plainly as it can be written: a pointer octree built by
// inserting one point after the other, every node with the set of its points (Sun et al. 2023, Sec.
// IV-A), every covariance computed from the points themselves in two passes, lists instead of
// sorted arrays. Of core/planes/segment it takes the options alone. What core/planes/segment must
// agree with, point by point, and what it is timed against.

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
  std::vector<Plane> planes;  // in order of founding, those that are left
};

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const planes::Cube& cube,
               const planes::SegmentOptions& options);

}  // namespace planescope::reference
