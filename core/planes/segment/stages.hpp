#pragma once

// Who decides: the stages of the paper, and those of the objective that `refined` minimizes.

#include <cstdint>
#include <vector>

namespace planescope::planes {

enum class Stage : std::uint8_t {
  criteria,  // Criteria 1-3, in the traversal
  merge,     // Criterion 4
  assign,    // leftovers go to planes
  join,      // by the objective: two regions that touch
  grow,      // pixels or points change hands
  hidden,    // two parts that something hides from each other
  parts,     // a plane falls into parts that do not touch
  list,      // what is worth being a plane
};

/// What a stage of the objective says of itself, wherever a decision is shown.
struct StageInfo {
  const char* title;  // "merge neighbors"
  /// What its `refine` event means, with {plane}, {other}, {point}, and the event's {value}, or as
  /// a length in {mm}, filled in (fmt).
  const char* says = "{plane} changes";
  /// Why a plane that it drops is none, where that needs saying; filled in likewise.
  const char* why_dropped = "";
  /// How a part that becomes a plane of its own and the rest of the old plane are related.
  const char* why_parted = "";
  bool on_pixels = false;  // does nothing where there is no depth image
};

/// "criteria", "merge", "assign", "join" ... "list".
const char* to_string(Stage stage);
/// Null for a stage of the paper.
const StageInfo* info_of(Stage stage);
/// All of them, in their order.
const std::vector<Stage>& stages();

}  // namespace planescope::planes
