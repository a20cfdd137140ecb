#include "app/desktop/debugger/timeline_columns.hpp"

#include <algorithm>

namespace planescope::desktop {

int column_of_step(std::int32_t step, std::int32_t steps, int count) {
  if (steps <= 0) return 0;
  return static_cast<int>(static_cast<std::int64_t>(step) * (count - 1) / steps);
}

std::vector<TimelineColumn> timeline_columns(const debug::Run& run, int count) {
  std::vector<TimelineColumn> columns(static_cast<std::size_t>(std::max(count, 0)));
  if (columns.empty()) return columns;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    TimelineColumn& column =
        columns[static_cast<std::size_t>(column_of_step(step, run.steps(), count))];
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
      case planes::EventType::leave:
        ++column.dropped;
        break;
      case planes::EventType::refine:
        ++column.refined;
        break;
      case planes::EventType::visit:
      case planes::EventType::wait:
        break;
    }
  }
  return columns;
}

}  // namespace planescope::desktop
