#pragma once

// The timeline: which steps it shows, where they are on the screen, what happened in each column of
// pixels, and what is drawn of it, row by row. The panel itself (panels/timeline.cpp) handles the
// mouse.

#include <array>
#include <cstdint>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/replay/steps.hpp"

struct ImVec2;

namespace planescope::desktop {

struct Ui;

/// The steps that the timeline shows: those the user chose, or else the traversal.
debug::StepRange shown_steps(const State& state);

/// A range `factor` times as long, between a few steps and all of them. The step `about` keeps its
/// place on the screen.
debug::StepRange zoomed(const debug::StepRange& range,
                        std::int32_t about,
                        double factor,
                        std::int32_t steps);
/// Moved by a number of steps, as far as there are any.
debug::StepRange moved(const debug::StepRange& range, std::int32_t by, std::int32_t steps);
/// Scrolled to a step if it is outside, with some room around the step.
debug::StepRange scrolled_to(const debug::StepRange& range, std::int32_t step, std::int32_t steps);

/// Steps side by side, each a box of the same width.
struct StepAxis {
  debug::StepRange steps;
  float x = 0, width = 0;  // [px]

  float step_width() const { return width / static_cast<float>(steps.count()); }
  float begin(std::int32_t step) const {
    return x + static_cast<float>(step - steps.first) * step_width();
  }
  float middle(std::int32_t step) const { return begin(step) + step_width() / 2; }
  /// The nearest one that is shown.
  std::int32_t at(float screen_x) const;
};

/// What the events of one column were.
struct TimelineColumn {
  std::array<std::uint32_t, 5> cases{};  // nodes settled, by Case
  std::uint32_t events = 0;
  std::uint32_t found = 0, merged = 0, assigned = 0, dropped = 0, refined = 0;
  std::int32_t plane = -1;  // that the last of them concerned

  std::uint32_t decided() const { return cases[1] + cases[2] + cases[3] + cases[4]; }
};

/// The events of some steps of a run spread over `count` columns.
std::vector<TimelineColumn> timeline_columns(const debug::Run& run,
                                             const debug::StepRange& steps,
                                             int count);
int column_of_step(std::int32_t step, const debug::StepRange& steps, int count);

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
