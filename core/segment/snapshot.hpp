#pragma once

// A run that is stopped on its way: what a replay of its trace must agree with.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/segment/segment.hpp"

namespace planescope {

/// A plane of the trace, as it stands.
struct SnapshotPlane {
  Label label = Label::unknown;
  Moments moments;
  PlaneFit fit;
  bool alive = true;
  std::int32_t into = -1;  // where R7 merged it
};

struct SegmentSnapshot {
  std::size_t events = 0;              // logged so far
  std::uint32_t visited = 0;           // nodes dequeued: the first ones
  std::vector<OctreeNode> nodes;       // made so far
  std::vector<std::int32_t> plane_of;  // per input point: plane of the trace, -1 none
  std::vector<std::uint8_t> leftover;  // per input point: left over, and in no plane yet
  std::vector<SnapshotPlane> planes;   // in order of founding
};

/// segment(), stopped just before it would log one event more than `events`, or at its end.
SegmentSnapshot segment_until(std::span<const Vec3f> points,
                              std::span<const Label> labels,
                              const Cube& cube,
                              const Vec3d& sensor,
                              const SegmentOptions& options,
                              std::size_t events,
                              const Measurements& more = {});

}  // namespace planescope
