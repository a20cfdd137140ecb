#include "app/desktop/debugger/event_rows.hpp"

#include <fmt/format.h>

#include "core/debug/replay/steps.hpp"
#include "core/model/text.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::desktop {
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

}  // namespace planescope::desktop
