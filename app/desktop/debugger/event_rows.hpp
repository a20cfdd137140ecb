#pragma once

// The event list as a person reads it: stages as headings, and what happens to many points in a row
// as one line that opens.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

struct EventRow {
  enum class Kind : std::uint8_t { stage, group, event };
  Kind kind = Kind::event;
  std::int32_t first = 0, last = 0;  // steps; of an event the same
  const char* title = "";            // of a stage: "traversal", "merge neighbors", "leftovers"
};

/// Stages and, below each, its events, those of one kind that follow one another as a group.
std::vector<EventRow> event_groups(const debug::Run& run);

/// These with the events of each group that is open (by its first step) or that the cursor is in.
std::vector<EventRow> opened(const std::vector<EventRow>& groups,
                             const std::set<std::int32_t>& open,
                             std::int32_t step);

/// "grow moves 43 points from P7 to P8", "80 points go to 5 planes, 12 stay without one".
std::string group_text(const debug::Run& run, const EventRow& group);

}  // namespace planescope::desktop
