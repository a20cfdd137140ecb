// Text and highlights of single steps of a run.

#include "core/debug/replay/steps.hpp"

#include <algorithm>

#include "core/planes/segment/trace.hpp"

namespace planescope::debug {
namespace {

using planes::EventType;
using planes::Stage;

/// The last step of the traversal, including the effects of its last node; 0 if no node was
/// dequeued.
std::int32_t end_of_traversal(const Run& run) {
  std::int32_t last = run.steps();
  const auto is_of_node = [&](std::int32_t step) {
    const EventType type = run.event_at(step)->type;
    return type == EventType::visit || type == EventType::decide;
  };
  while (last > 0 && !is_of_node(last)) --last;
  const auto follows = [](Stage stage) {
    return stage == Stage::merge || stage == Stage::criteria;
  };
  while (last < run.steps() && follows(run.event_at(last + 1)->stage)) ++last;
  return last;
}

const char* title_of(const planes::TraceEvent& event) {
  if (event.type == EventType::visit) return "traversal";
  if (const planes::StageInfo* info = planes::info_of(event.stage)) return info->title;
  return event.stage == Stage::assign ? "leftovers" : "merging";
}

/// Steps that create, join or drop a plane, or merge a candidate into one; ascending.
std::vector<std::int32_t> plane_steps(const Run& run) {
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const EventType type = run.event_at(step)->type;
    if (type == EventType::found || type == EventType::merge) steps.push_back(step);
  }
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    bool alive = false;
    for (const planes::PlaneChange& change : run.timeline.changes_of_plane(plane)) {
      if (change.alive != alive && change.step > 0) steps.push_back(change.step);
      alive = change.alive;
    }
  }
  std::ranges::sort(steps);
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  return steps;
}

std::vector<std::int32_t> node_steps(const Run& run) {
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (run.event_at(step)->type == EventType::decide) steps.push_back(step);
  return steps;
}

}  // namespace

std::vector<Phase> phases_of(const Run& run) {
  std::vector<Phase> phases;
  const std::int32_t traversed = end_of_traversal(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    const bool begins = step == 1 || step == traversed + 1 ||
                        (step > traversed && event.stage != run.event_at(step - 1)->stage);
    if (begins) phases.push_back({{step, step}, title_of(event)});
    phases.back().steps.last = step;
  }
  return phases;
}

StepRange traversal_of(const Run& run) {
  const std::int32_t traversed = end_of_traversal(run);
  return {0, traversed > 0 ? traversed : run.steps()};
}

std::int32_t step_from(const Run& run, StepUnit unit, std::int32_t step, std::int32_t count) {
  const std::int32_t end = run.steps();
  if (unit == StepUnit::event)
    return static_cast<std::int32_t>(
        std::clamp(static_cast<std::int64_t>(step) + count, std::int64_t{0}, std::int64_t{end}));
  const std::vector<std::int32_t> stops =
      unit == StepUnit::node ? node_steps(run) : plane_steps(run);
  if (count == 0) return step;
  // Index of the stop, if it exists.
  const std::int64_t index =
      count > 0 ? std::ranges::upper_bound(stops, step) - stops.begin() + (count - 1)
                : std::ranges::lower_bound(stops, step) - stops.begin() + count;
  return index < 0 ? 0 : index >= std::ssize(stops) ? end : stops[static_cast<std::size_t>(index)];
}

StateWalk::StateWalk(const Run& run)
    : run_(run), state_{run.segment_options, run.subject->prepared.sensor()} {
  state_.octree = run.octree();
  state_.noise = run.segmentation.noise;
  state_.plane_of.assign(run.octree().order.size(), -1);
}

const planes::SegmentState& StateWalk::advance_to(std::int32_t step) {
  const std::vector<planes::Trace::Point>& points = run_.trace.points;
  for (; points_ < points.size() && points[points_].change.step <= step; ++points_)
    state_.plane_of[points[points_].point] = points[points_].change.plane;
  const std::vector<planes::Trace::Plane>& planes = run_.trace.planes;
  bool joined = false;
  for (; planes_ < planes.size() && planes[planes_].change.step <= step; ++planes_) {
    const auto plane = static_cast<std::size_t>(planes[planes_].plane);
    if (plane == state_.planes.size()) state_.planes.emplace_back();
    state_.planes[plane] = planes[planes_].change;
    joined = joined || planes[planes_].change.into >= 0;
  }
  if (joined)
    for (std::int32_t& plane : state_.plane_of)
      if (plane >= 0) plane = run_.timeline.joined_plane(plane, step);
  return state_;
}

}  // namespace planescope::debug
