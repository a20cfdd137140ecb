#pragma once

// The rows of the octree view: the part of the tree that exists at a step, folded where it is
// settled.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

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
