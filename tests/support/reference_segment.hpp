#pragma once

// The method once more, as plainly as it can be written: a pointer octree built by inserting one
// point after the other, every node with the set of its points (Sun et al. 2023, Sec. IV-A), every
// covariance computed from the points themselves in two passes, std::map instead of sorted arrays.
// Of core/planes/segment it takes the options alone. What core/planes/segment must agree with,
// point by point, and what it is timed against.

#include <span>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::reference {

struct Plane {
  Label label;
  PlaneFit fit;
};

/// What SplitRule::seen came upon.
struct Gaps {
  int open = 0, hidden = 0;  // pairs of parts: the plane was seen through between them, or not
  int scraps = 0;            // parts that could be no planes of their own
  int splits = 0;            // planes that became several
};

struct Result {
  std::vector<int> plane_of;  // per input point: index into planes, -1 none
  std::vector<Plane> planes;  // in order of founding, those that are left
  Gaps gaps;
};

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const planes::Cube& cube,
               const Vec3d& sensor,
               const planes::SegmentOptions& options,
               const planes::Measurements& more = {});

}  // namespace planescope::reference
