// What the colours of a step's picture mean.

#include <algorithm>
#include <string>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/step_parts.hpp"

namespace planescope::render {
namespace {

using Mark = LegendEntry::Mark;

void add_cases(const debug::Run& run, std::int32_t step, Rgba waiting, DrawList& list) {
  std::size_t count[5] = {}, hatched = 0, queued = 0;
  for (std::size_t i = 0; i < run.octree().nodes.size(); ++i) {
    const planes::OctreeNode& node = run.octree().nodes[i];
    if (run.timeline.decided_at()[i] <= step) {
      ++count[static_cast<int>(node.decided)];
      hatched += node.at_max_depth;
    } else {
      queued += run.timeline.queued_at()[i] <= step;
    }
  }
  add_case_legend(count, list);
  if (hatched > 0)
    list.legend.push_back({Mark::hatched_box, case_color(planes::Case::III),
                           "at full depth: left over  " + std::to_string(hatched)});
  if (queued > 0)
    list.legend.push_back({Mark::dot, waiting, "in the queue  " + std::to_string(queued)});
}

void add_plane_states(const StepState& state, Rgba waiting, DrawList& list) {
  const auto holds = [&](std::int32_t what) {
    return std::count(state.plane_of.begin(), state.plane_of.end(), what);
  };
  const auto entry = [&](Rgba color, const std::string& text, std::ptrdiff_t count) {
    if (count > 0) list.legend.push_back({Mark::dot, color, text + "  " + std::to_string(count)});
  };
  entry(leftover_color(), "left over", holds(StepState::kLeftover));
  entry(waiting, "not settled yet", holds(StepState::kOpen));
}

}  // namespace

void add_step_legend(const debug::Run& run,
                     const StepLook& look,
                     const StepState& state,
                     DrawList& list) {
  const Rgba waiting = mark_colors(look.theme).waiting;
  switch (told_by(run, look.color_by)) {
    case ColorBy::cases:
      add_cases(run, look.step, waiting, list);
      break;
    case ColorBy::planes:
      add_plane_states(state, waiting, list);
      break;
    case ColorBy::labels:
      if (!run.subject->prepared.gravity.known()) {
        list.legend.push_back(
            {Mark::dot, label_color(Label::unknown), "neither h nor v: gravity is not known"});
        break;
      }
      list.legend.push_back({Mark::dot, label_color(Label::h), "h  level"});
      list.legend.push_back({Mark::dot, label_color(Label::v), "v  upright"});
      if (!run.is_ours())
        list.legend.push_back({Mark::dot, label_color(Label::unknown), "in no plane"});
      break;
    case ColorBy::margins:
      list.legend.push_back({Mark::dot, margin_color(Label::h, 1), "h, sure"});
      list.legend.push_back({Mark::dot, margin_color(Label::v, 1), "v, sure"});
      list.legend.push_back({Mark::dot, margin_color(Label::h, 0), "unsure"});
      break;
    case ColorBy::truth:
      if (!run.subject->voxel_truth.known()) {
        list.legend.push_back({Mark::dot, waiting, "this frame has no ground truth"});
      } else {
        list.legend.push_back({Mark::dot, leftover_color(), "in no true plane"});
        list.legend.push_back({Mark::dot, waiting, "not scored"});
      }
      break;
    case ColorBy::camera:
      break;
  }
  if (!look.marked.empty())
    list.legend.push_back({Mark::dot, mark_colors(look.theme).marked,
                           "marked  " + std::to_string(look.marked.size())});
}

}  // namespace planescope::render
