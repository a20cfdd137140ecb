#include "app/desktop/debugger/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/debug/replay/steps.hpp"
#include "core/model/text.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::desktop {

// ---- Events -------------------------------------------------------------------------------------

namespace {

constexpr std::int32_t kLeastGroup = 3;  // two lines are read as quickly as one

bool is_leftover(const planes::TraceEvent& event) {
  return event.point >= 0 &&
         (event.type == planes::EventType::assign || event.type == planes::EventType::drop);
}

/// Whether the second goes on with what the first does.
bool same_kind(const planes::TraceEvent& a, const planes::TraceEvent& b) {
  if (a.stage != b.stage || a.point < 0 || b.point < 0) return false;
  if (is_leftover(a)) return is_leftover(b);
  if (a.type != planes::EventType::refine || b.type != a.type) return false;
  // What looks at pixels goes by place, not plane by plane.
  return planes::info_of(a.stage)->on_pixels || (a.plane == b.plane && a.other == b.other);
}

}  // namespace

std::vector<EventRow> event_groups(const debug::Run& run) {
  std::vector<EventRow> rows;
  for (const debug::Phase& phase : debug::phases_of(run)) {
    rows.push_back({EventRow::Kind::stage, phase.steps.first, phase.steps.last, phase.title});
    for (std::int32_t step = phase.steps.first, end = step; step <= phase.steps.last; step = end) {
      const planes::TraceEvent& event = *run.event_at(step);
      end = step + 1;
      while (end <= phase.steps.last && same_kind(event, *run.event_at(end))) ++end;
      if (end - step < kLeastGroup) end = step + 1;
      rows.push_back(
          {end > step + 1 ? EventRow::Kind::group : EventRow::Kind::event, step, end - 1});
    }
  }
  return rows;
}

std::vector<EventRow> opened(const std::vector<EventRow>& groups,
                             const std::set<std::int32_t>& open,
                             std::int32_t step) {
  std::vector<EventRow> rows;
  for (const EventRow& row : groups) {
    rows.push_back(row);
    if (row.kind != EventRow::Kind::group) continue;
    // At its end all of it has happened, and one line tells that.
    const bool inside = step >= row.first && step < row.last;
    if (!inside && !open.contains(row.first)) continue;
    for (std::int32_t at = row.first; at <= row.last; ++at)
      rows.push_back({EventRow::Kind::event, at, at});
  }
  return rows;
}

std::string group_text(const debug::Run& run, const EventRow& group) {
  const planes::TraceEvent& first = *run.event_at(group.first);
  const auto count = static_cast<std::size_t>(group.last - group.first + 1);
  std::set<std::int32_t> planes;
  if (!is_leftover(first)) {
    bool all_alike = true;
    for (std::int32_t step = group.first; step <= group.last; ++step) {
      const planes::TraceEvent& event = *run.event_at(step);
      planes.insert({event.plane, event.other});
      all_alike = all_alike && event.plane == first.plane && event.other == first.other;
    }
    const std::string what =
        fmt::format("{} moves {} ", planes::to_string(first.stage), counted(count, "point"));
    if (!all_alike) return what + "between " + counted(planes.size(), "plane");
    return what + fmt::format("from {} to {}", debug::plane_name(run, first.plane),
                              debug::plane_name(run, first.other));
  }
  std::size_t given = 0;
  for (std::int32_t step = group.first; step <= group.last; ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.type != planes::EventType::assign) continue;
    ++given;
    planes.insert(event.plane);
  }
  const std::size_t left = count - given;
  if (given == 0) return counted(left, "point") + (left == 1 ? " stays" : " stay") + " unassigned";
  std::string text = fmt::format("{} {} to {}", counted(given, "point"), given == 1 ? "goes" : "go",
                                 planes.size() == 1 ? debug::plane_name(run, *planes.begin())
                                                    : counted(planes.size(), "plane"));
  if (left > 0) text += fmt::format(", {} {} unassigned", left, left == 1 ? "stays" : "stay");
  return text;
}

// ---- The octree ---------------------------------------------------------------------------------

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
