#pragma once

// How a trace is divided: its phases, and the steps at which nodes are decided or planes come and
// go.

#include <cstdint>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::debug {

/// Steps from the first to the last, both included.
struct StepRange {
  std::int32_t first = 0, last = 0;

  std::int32_t count() const { return last - first + 1; }
  bool contains(std::int32_t step) const { return step >= first && step <= last; }
  bool operator==(const StepRange&) const = default;
};

/// Steps in a row that one stage decided.
struct Phase {
  StepRange steps;
  const char* title = "";  // "traversal", "merge neighbors", "leftovers"
};

/// All steps from 1 on, in order. What the traversal leads to at once, as merges, is part of it.
std::vector<Phase> phases_of(const Run& run);

/// From the beginning to the end of the traversal; all steps if there is none.
StepRange traversal_of(const Run& run);

/// How far one step goes: to the next event, to the next node that is decided, or to the next event
/// that founds, joins, splits or drops a plane.
enum class StepUnit : std::uint8_t { event, node, plane };

/// The step `count` units after `step`, or before it where `count` is negative. The beginning and
/// the end of the trace are stops of every unit.
std::int32_t step_from(const Run& run, StepUnit unit, std::int32_t step, std::int32_t count);

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
