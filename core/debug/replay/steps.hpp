#pragma once

// Divides a trace into phases, and finds the steps at which nodes are decided and planes change.

#include <cstdint>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::debug {

/// Steps from first to last, inclusive.
struct StepRange {
  std::int32_t first = 0, last = 0;

  std::int32_t count() const { return last - first + 1; }
  bool contains(std::int32_t step) const { return step >= first && step <= last; }
  bool operator==(const StepRange&) const = default;
};

/// Consecutive steps decided by one stage.
struct Phase {
  StepRange steps;
  const char* title = "";  // "traversal", "merge neighbors", "leftovers"
};

/// All steps from 1 on, in order. Immediate effects of the traversal, such as merges, are part
/// of it.
std::vector<Phase> phases_of(const Run& run);

/// From the first to the last step of the traversal; all steps if there is none.
StepRange traversal_of(const Run& run);

/// Size of one step: to the next event, to the next decision on a node, or to the next event that
/// creates, joins, splits or drops a plane.
enum class StepUnit : std::uint8_t { event, node, plane };

/// The step `count` units after `step` (before it if `count` is negative). The first and last steps
/// are stops of every unit.
std::int32_t step_from(const Run& run, StepUnit unit, std::int32_t step, std::int32_t count);

/// Replays the changes of planes and their points in a trace, forward only. The octree contains all
/// nodes from the start. The state has no counts, and leftovers are unordered.
class StateWalk {
 public:
  explicit StateWalk(const Run& run);
  /// Advances to the state at `step`, which must not precede the current one.
  const planes::SegmentState& advance_to(std::int32_t step);
  const planes::SegmentState& state() const { return state_; }

 private:
  const Run& run_;
  planes::SegmentState state_;
  std::size_t points_ = 0, planes_ = 0;  // number of applied changes
};

}  // namespace planescope::debug
