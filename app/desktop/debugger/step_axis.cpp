#include "app/desktop/debugger/step_axis.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::desktop {
namespace {

constexpr std::int32_t kFewestSteps = 10;  // that can be zoomed to

/// As long as `range`, and within the trace.
debug::StepRange within(std::int32_t first, std::int32_t count, std::int32_t steps) {
  count = std::clamp(count, 1, steps + 1);
  first = std::clamp(first, 0, steps + 1 - count);
  return {first, first + count - 1};
}

}  // namespace

debug::StepRange shown_steps(const State& state) {
  const debug::Run* run = state.run();
  if (!run) return {};
  const std::optional<debug::StepRange>& chosen = state.view.shown_steps;
  return chosen ? within(chosen->first, chosen->count(), run->steps()) : traversal_of(*run);
}

debug::StepRange zoomed(const debug::StepRange& range,
                        std::int32_t about,
                        double factor,
                        std::int32_t steps) {
  std::int32_t count = static_cast<std::int32_t>(std::lround(range.count() * factor));
  if (factor > 1) count = std::max(count, range.count() + 1);  // a few steps are zoomed, too
  if (factor < 1) count = std::min(count, range.count() - 1);
  count = std::clamp(count, std::min(kFewestSteps, steps + 1), steps + 1);
  const double share = (about - range.first + 0.5) / range.count();
  return within(static_cast<std::int32_t>(std::lround(about + 0.5 - share * count)), count, steps);
}

debug::StepRange moved(const debug::StepRange& range, std::int32_t by, std::int32_t steps) {
  return within(range.first + by, range.count(), steps);
}

debug::StepRange scrolled_to(const debug::StepRange& range, std::int32_t step, std::int32_t steps) {
  if (range.contains(step)) return range;
  const std::int32_t count = range.count(), room = count / 8;
  const bool near = step >= range.first - count && step <= range.last + count;
  const std::int32_t first = !near                ? step - count / 2
                             : step < range.first ? step - room
                                                  : step + room - count + 1;
  return within(first, count, steps);
}

std::int32_t StepAxis::at(float screen_x) const {
  const double share =
      std::clamp((screen_x - x) / static_cast<double>(std::max(1.0f, width)), 0.0, 1.0);
  return std::min(steps.last,
                  steps.first + static_cast<std::int32_t>(std::floor(share * steps.count())));
}

int column_of_step(std::int32_t step, const debug::StepRange& steps, int count) {
  const std::int64_t halves = 2 * static_cast<std::int64_t>(step - steps.first) + 1;
  return static_cast<int>(halves * count / (2 * static_cast<std::int64_t>(steps.count())));
}

std::vector<TimelineColumn> timeline_columns(const debug::Run& run,
                                             const debug::StepRange& steps,
                                             int count) {
  std::vector<TimelineColumn> columns(static_cast<std::size_t>(std::max(count, 0)));
  if (columns.empty()) return columns;
  for (std::int32_t step = std::max(1, steps.first); step <= steps.last; ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    TimelineColumn& column = columns[static_cast<std::size_t>(column_of_step(step, steps, count))];
    ++column.events;
    if (event.plane >= 0) column.plane = event.plane;
    switch (event.type) {
      case planes::EventType::decide:
        ++column.cases[event.node_case];
        break;
      case planes::EventType::found:
        ++column.found;
        break;
      case planes::EventType::merge:
        ++column.merged;
        break;
      case planes::EventType::assign:
        ++column.assigned;
        break;
      case planes::EventType::drop:
        ++column.dropped;
        break;
      case planes::EventType::refine:
        ++column.refined;
        break;
      case planes::EventType::visit:
        break;
    }
  }
  return columns;
}

}  // namespace planescope::desktop
