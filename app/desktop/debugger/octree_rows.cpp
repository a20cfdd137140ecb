#include "app/desktop/debugger/octree_rows.hpp"

#include <algorithm>
#include <charconv>

namespace planescope::desktop {
namespace {

/// Per node, the step from which on it and everything below it are settled.
std::vector<std::int32_t> settled_below(const debug::Run& run) {
  const auto decided = run.timeline.decided_at();
  std::vector<std::int32_t> settled(decided.begin(), decided.end());
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  for (std::size_t n = nodes.size(); n-- > 1;) {  // children stand behind their parents
    std::int32_t& parent = settled[static_cast<std::size_t>(nodes[n].parent)];
    parent = std::max(parent, settled[n]);
  }
  return settled;
}

std::vector<std::uint8_t> path_to(const debug::Run& run, std::int32_t node) {
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  std::vector<std::uint8_t> on_path(nodes.size(), 0);
  while (node > 0) {
    node = nodes[static_cast<std::size_t>(node)].parent;
    on_path[static_cast<std::size_t>(node)] = 1;
  }
  return on_path;
}

bool is_born(const debug::Run& run, std::int32_t node, std::int32_t step) {
  return run.timeline.node_state(node, step) != debug::NodeState::unborn;
}

bool has_born_children(const debug::Run& run, std::int32_t node, std::int32_t step) {
  const std::int32_t child = run.octree().nodes[static_cast<std::size_t>(node)].first_child;
  return child >= 0 && is_born(run, child, step);
}

}  // namespace

std::vector<OctreeRow> octree_rows(const debug::Run& run,
                                   std::int32_t step,
                                   std::int32_t selected,
                                   const std::map<std::int32_t, bool>& folds) {
  std::vector<OctreeRow> rows;
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  if (nodes.empty()) return rows;
  const std::vector<std::int32_t> settled = settled_below(run);
  const std::vector<std::uint8_t> on_path = path_to(run, selected);
  std::vector<std::int32_t> next = {0};  // a stack: what is to come, the first at its top
  while (!next.empty()) {
    const std::int32_t index = next.back();
    const auto n = static_cast<std::size_t>(index);
    const planes::OctreeNode& node = nodes[n];
    next.pop_back();
    OctreeRow row{index, node.depth, has_born_children(run, index, step), false};
    if (row.has_children) {
      const auto fold = folds.find(index);
      row.open = fold != folds.end() ? fold->second : settled[n] > step || on_path[n] != 0;
    }
    rows.push_back(row);
    for (std::int32_t child = node.child_count; row.open && child-- > 0;)
      next.push_back(node.first_child + child);
  }
  return rows;
}

std::vector<OctreeRow> octree_matches(const debug::Run& run,
                                      std::int32_t step,
                                      const std::string& search,
                                      debug::FilterProblem& problem) {
  problem = {};
  std::vector<OctreeRow> rows;
  const auto add = [&](std::int32_t node) {
    rows.push_back({node, 0, has_born_children(run, node, step), false});
  };
  std::int32_t number = -1;
  const char* end = search.data() + search.size();
  if (const auto [stopped, error] = std::from_chars(search.data(), end, number);
      error == std::errc() && stopped == end) {
    const auto count = static_cast<std::int32_t>(run.octree().nodes.size());
    if (number >= 0 && number < count && is_born(run, number, step)) add(number);
    return rows;
  }
  const auto filter = debug::Filter::parse(search, problem);
  if (!filter) return rows;
  std::vector<std::uint8_t> found(run.octree().nodes.size(), 0);
  for (const std::int32_t match : filter->matching(run)) {
    if (match > step) break;
    if (const std::int32_t node = run.event_at(match)->node; node >= 0)
      found[static_cast<std::size_t>(node)] = 1;
  }
  for (std::size_t n = 0; n < found.size(); ++n)
    if (found[n]) add(static_cast<std::int32_t>(n));
  return rows;
}

SubtreeCounts count_subtree(const debug::Run& run, std::int32_t step, std::int32_t node) {
  // Nodes are in breadth-first order: those of one depth below a node stand side by side.
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  SubtreeCounts counts = {};
  std::int32_t begin = node, end = node + 1;
  while (begin < end) {
    std::int32_t first = -1, last = -1;
    for (std::int32_t n = begin; n < end; ++n) {
      const planes::OctreeNode& parent = nodes[static_cast<std::size_t>(n)];
      if (!has_born_children(run, n, step)) continue;
      if (first < 0) first = parent.first_child;
      last = parent.first_child + parent.child_count;
    }
    for (std::int32_t n = first; n < last; ++n) {
      const bool settled = run.timeline.node_state(n, step) == debug::NodeState::settled;
      ++counts[settled ? static_cast<std::size_t>(nodes[static_cast<std::size_t>(n)].decided) : 0];
    }
    begin = first;
    end = last;
  }
  return counts;
}

}  // namespace planescope::desktop
