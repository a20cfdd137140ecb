#pragma once

// Rows of the debugger's lists. Events as a person reads them: stages as headings, and what happens
// to many points in a row as one line that opens. The octree: the part of it that exists at a step,
// folded where it is settled.

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

// ---- Events -------------------------------------------------------------------------------------

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

// ---- The octree ---------------------------------------------------------------------------------

struct OctreeRow {
  std::int32_t node = -1;
  int indent = 0;
  bool has_children = false;  // that are born
  bool open = false;
};

/// Depth first, from the root. A node is open where something below it is not settled yet, or where
/// it leads to `selected`, unless the user wants it otherwise (`folds`: by node, open or closed).
std::vector<OctreeRow> octree_rows(const debug::Run& run,
                                   std::int32_t step,
                                   std::int32_t selected,
                                   const std::map<std::int32_t, bool>& folds);

/// The nodes that a search finds among those that are born: by number, or by a filter over what has
/// happened so far. `problem` says what is wrong with it.
std::vector<OctreeRow> octree_matches(const debug::Run& run,
                                      std::int32_t step,
                                      const std::string& search,
                                      debug::FilterProblem& problem);

/// Nodes below one, itself not counted, by Case; those not settled yet as Case::none.
using SubtreeCounts = std::array<std::uint32_t, 5>;
SubtreeCounts count_subtree(const debug::Run& run, std::int32_t step, std::int32_t node);

}  // namespace planescope::desktop
