#pragma once

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// Where running stops, for rows of events: filters made once per frame.
class BreakpointMarks {
 public:
  explicit BreakpointMarks(const Document& document);
  enum class Mark { none, off, on };
  Mark of(const debug::Run& run, std::int32_t step) const;

 private:
  struct Stop {
    debug::Filter filter;
    bool enabled;
  };
  std::vector<Stop> stops_;
};

/// Each breakpoint with a switch and a cross, in one line.
void draw_breakpoints(const Ui& ui);
/// Sets or removes a breakpoint on what the event is about.
void toggle_breakpoint(const Ui& ui, const planes::TraceEvent& event);
/// A breakpoint's dot about a point of the window.
void draw_breakpoint_dot(const Ui& ui, ImVec2 centre, BreakpointMarks::Mark mark);

}  // namespace planescope::desktop
