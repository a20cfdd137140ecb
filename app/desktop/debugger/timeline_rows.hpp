#pragma once

// What the timeline draws, row by row. The panel itself (panels/timeline.cpp) handles the mouse.

#include <cstdint>

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// The rows on the screen, from top to bottom, by their upper edges.
struct TimelineRows {
  StepAxis axis;  // of the steps shown
  float phases = 0, marks = 0, cases = 0, planes = 0, matches = 0, end = 0;
  float overview = 0, bottom = 0;

  int columns() const { return static_cast<int>(axis.width); }
  /// All steps over the same width, for the overview.
  StepAxis whole(std::int32_t steps) const { return {{0, steps}, axis.x, axis.width}; }
};
TimelineRows timeline_rows(const Ui& ui, ImVec2 at, ImVec2 room, const debug::StepRange& shown);

/// Brings what is kept of the run up to date.
void refresh_timeline(const Ui& ui, const TimelineRows& rows);

/// Each phase as a band with its name.
void draw_phases(const Ui& ui, const TimelineRows& rows);
/// Cases and planes: a box for each step where they are wide enough, a summary of each column of
/// pixels otherwise.
void draw_steps(const Ui& ui, const TimelineRows& rows);
/// Breakpoints, bookmarks, matches of the filter, the step where A and B diverge.
void draw_step_marks(const Ui& ui, const TimelineRows& rows);
/// The cursor, or an arrow at the edge behind which it is; and the step under the mouse, -1: none.
void draw_step_cursor(const Ui& ui, const TimelineRows& rows, std::int32_t hovered);
/// All of the trace, with a frame around the steps shown.
void draw_overview(const Ui& ui, const TimelineRows& rows);

}  // namespace planescope::desktop
