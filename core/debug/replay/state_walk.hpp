#pragma once

// The segmentation as it stood at a step, to repeat a choice that was made there.

#include "core/debug/replay/run.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::debug {

/// Walks forward through the changes of a trace: planes, and the points in them. The octree has
/// all nodes from the start. The state holds neither counts nor the order of the leftovers.
class StateWalk {
 public:
  explicit StateWalk(const Run& run);
  /// To the state at `step`, not before where it is.
  const planes::SegmentState& advance_to(std::int32_t step);
  const planes::SegmentState& state() const { return state_; }

 private:
  const Run& run_;
  planes::SegmentState state_;
  std::size_t points_ = 0, planes_ = 0;  // changes that are made
};

}  // namespace planescope::debug
