#pragma once

// From a trace to what changed at each step. Internal to core/replay.

#include <cstdint>
#include <vector>

#include "core/replay/timeline.hpp"

namespace planescope {

/// Changes in the order of their steps.
struct ReplayedTrace {
  std::vector<std::int32_t> queued_at, visited_at, decided_at;  // per node
  struct Point {
    std::int32_t point;  // index in segment()'s input
    PointChange change;
  };
  std::vector<Point> points;
  struct Plane {
    std::int32_t plane;
    PlaneChange change;
  };
  std::vector<Plane> planes;
  std::vector<Label> plane_labels;  // per plane of the trace
};
ReplayedTrace replay_trace(const Trace& trace, const Octree& octree, const SegmentOptions& options);

}  // namespace planescope
