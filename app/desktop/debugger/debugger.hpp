#pragma once

// What the debugger's panels share, most of it pure functions: rows of the events and of the
// octree, the timeline, texts about planes and stairs, axes of sliders and histograms, the filter
// box.

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"
#include "core/debug/replay/steps.hpp"
#include "core/planes/pipeline/options_table.hpp"

struct ImVec2;

namespace planescope::desktop {

// ---- Events -------------------------------------------------------------------------------------

struct EventRow {
  enum class Kind : std::uint8_t { stage, group, event };
  Kind kind = Kind::event;
  std::int32_t first = 0, last = 0;  // steps; of an event the same
  const char* title = "";            // of a stage: "traversal", "merge neighbors", "leftovers"
};

/// Stages and, below each, its events, those of one kind that follow one another as a group.
std::vector<EventRow> event_groups(const debug::Run& run);

/// These with the events of each group that is open (by its first step) or that the cursor is in.
std::vector<EventRow> opened(const std::vector<EventRow>& groups,
                             const std::set<std::int32_t>& open,
                             std::int32_t step);

/// "grow moves 43 points from P7 to P8", "80 points go to 5 planes, 12 stay without one".
std::string group_text(const debug::Run& run, const EventRow& group);

// ---- The octree ---------------------------------------------------------------------------------

struct OctreeRow {
  std::int32_t node = -1;
  int indent = 0;
  bool has_children = false;  // that are born
  bool open = false;
};

/// Depth first, from the root. A node is open where something below it is not settled yet, or where
/// it leads to `selected`, unless the user wants it otherwise (`folds`: by node, open or closed).
std::vector<OctreeRow> octree_rows(const debug::Run& run,
                                   std::int32_t step,
                                   std::int32_t selected,
                                   const std::map<std::int32_t, bool>& folds);

/// The nodes that a search finds among those that are born: by number, or by a filter over what has
/// happened so far. `problem` says what is wrong with it.
std::vector<OctreeRow> octree_matches(const debug::Run& run,
                                      std::int32_t step,
                                      const std::string& search,
                                      debug::FilterProblem& problem);

/// Nodes below one, itself not counted, by Case; those not settled yet as Case::none.
using SubtreeCounts = std::array<std::uint32_t, 5>;
SubtreeCounts count_subtree(const debug::Run& run, std::int32_t step, std::int32_t node);

// The timeline: which steps it shows, where they are on the screen, what happened in each column of
// pixels, and what is drawn of it, row by row. The panel itself (panels/timeline.cpp) handles the
// mouse.

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

// ---- The table ----------------------------------------------------------------------------------

/// What is not known is NaN.
struct PlaneRow {
  int id = 0;               // as in planes.json
  std::int32_t plane = -1;  // of the trace
  Label label = Label::unknown;
  double area_m2 = 0, tilt_deg = 0, rms_m = 0;
  std::uint64_t points = 0;
  double support = 0;  // share of what its outline covers that was measured
  bool foot = false;   // one is given, and `steppable` means something
  bool steppable = false;
  double margin = 0;  // as in planes.json; infinite: no objective was minimized
  bool undecided = false;
};

struct PlaneColumn {
  const char* name;    // in actions and of widgets
  const char* title;   // as short as its numbers
  const char* widest;  // text that it has room for
  const char* meaning;
  bool largest_first;                    // at the first click
  std::string (*text)(const PlaneRow&);  // "–" where it is not known
  double (*key)(const PlaneRow&);        // to sort by; NaN where it is not known
};
std::span<const PlaneColumn> plane_columns();
/// Those that the filter leaves, sorted; empty while they are found out. Each word of the filter is
/// in one of the row's texts, or in "level", "upright", "steppable", "not steppable",
/// "undecided".
std::vector<PlaneRow> plane_rows(const State& state);

/// The same rows with a header, numbers in SI units with all their digits.
std::string planes_csv(const std::vector<PlaneRow>& rows);

// ---- Texts --------------------------------------------------------------------------------------

/// What is known of the run looked at and its plane's number in the result, from 1; 0 before the
/// last step, and of planes that did not stay.
int finished_plane(const State& state, std::int32_t plane);

/// "steppable", "not steppable: 17 mm rough, limit 10"; empty where that is not known.
std::string verdict_text(const State& state, std::int32_t plane);

/// "P1, 0.52 m2, slope 1.2 deg" and, in a second line, the verdict.
std::string describe_plane(const State& state, std::int32_t plane);

/// Area, slope, roughness, support, certainty, clearance, height; empty where none is known.
struct PlaneLine {
  std::string name, value, meaning;
};
std::vector<PlaneLine> plane_lines(const State& state, std::int32_t plane);

/// Of a level plane: why no step leads up to it, or from it.
std::vector<std::string> no_steps_of(const State& state, std::int32_t plane);

/// A flight, kerb or ramp: a line, further ones, and the planes that it leads over.
struct StairsEntry {
  std::string title;
  std::vector<std::string> lines;
  std::vector<std::int32_t> planes;  // of the trace
};
std::vector<StairsEntry> stairs_entries(const State& state);

// ---- Sliders -----------------------------------------------------------------------------------

/// From `low` to `high`, by ratio where logarithmic. Values of the option beyond these are typed.
struct SliderScale {
  double low = 0, high = 1;
  bool logarithmic = false;
  double standard = 0;  // the profile's default

  double share(double value) const;  // 0..1
  double value(double share) const;
};
/// Wide enough to hold the default a few times over, within the option's range.
SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile);

// ---- Histograms --------------------------------------------------------------------------------

/// Where values stand across a histogram that gives every bin the same width: the last bin takes
/// what lies far out, logarithmic bins take the decades.
class HistogramAxis {
 public:
  explicit HistogramAxis(const debug::Histogram& histogram) : histogram_(histogram) {}
  double share(double value) const;  // 0..1
  double value(double share) const;

 private:
  const debug::Histogram& histogram_;
};

/// Round values across the axis, ascending: 1, 2 and 5 times powers of ten, its ends' own where
/// that is fewer than two.
std::vector<double> axis_ticks(const debug::Histogram& histogram);

/// The filter for the values from one share to another; empty where the quantity is not in the
/// language.
std::string filter_between(const debug::Histogram& histogram, double from, double to);

// A box for a filter: what is wrong with it underlined, completions under the cursor.

struct Ui;

struct FilterBox {
  std::string widget;                   // its name
  std::string hint;                     // shown while it is empty
  std::string text;                     // as the state has it
  const debug::FilterProblem* problem;  // with that; null or without a message: none
  std::string action;                   // takes the text, at every key
  std::string on_enter;                 // action; empty: none
};
void draw_filter_box(const Ui& ui, const FilterBox& box, float width);

/// A filter being typed, from frame to frame.
struct FilterBoxMemory {
  std::string text;     // follows the state until it is edited
  std::string applied;  // what of the state it follows
  int cursor = 0;
  int place_cursor = -1;  // where to put it once the box has the keyboard again
  int chosen = 0;         // of the completions
  bool take_keyboard = false, popup_hovered = false;
};

}  // namespace planescope::desktop
