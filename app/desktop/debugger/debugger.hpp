#pragma once

// Shared by the debugger's panels, mostly pure functions: rows of the event list and octree, the
// timeline, texts about planes and stairs, axes of sliders and histograms, the filter box.

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
  std::int32_t first = 0, last = 0;  // steps; equal for an event
  const char* title = "";            // for a stage: "traversal", "merge neighbors", "leftovers"
};

/// Stages and their events, with consecutive events of the same kind as one group.
std::vector<EventRow> event_groups(const debug::Run& run);

/// The same with the events of each group that is open (by first step) or contains the cursor.
std::vector<EventRow> opened(const std::vector<EventRow>& groups,
                             const std::set<std::int32_t>& open,
                             std::int32_t step);

/// "grow moves 43 points from P7 to P8", "80 points go to 5 planes, 12 stay without one".
std::string group_text(const debug::Run& run, const EventRow& group);

// ---- Octree -------------------------------------------------------------------------------------

struct OctreeRow {
  std::int32_t node = -1;
  int indent = 0;
  bool has_children = false;  // among existing nodes
  bool open = false;
};

/// Existing nodes depth first from the root. A node is open if a node below it is not settled yet
/// or is `selected`, unless the user opened or closed it (`folds`, by node).
std::vector<OctreeRow> octree_rows(const debug::Run& run,
                                   std::int32_t step,
                                   std::int32_t selected,
                                   const std::map<std::int32_t, bool>& folds);

/// Existing nodes that match a search: a number, or a filter over the events so far. `problem`
/// receives the error in an invalid search.
std::vector<OctreeRow> octree_matches(const debug::Run& run,
                                      std::int32_t step,
                                      const std::string& search,
                                      debug::FilterProblem& problem);

/// Number of nodes below a node, by Case; unsettled ones count as Case::none.
using SubtreeCounts = std::array<std::uint32_t, 5>;
SubtreeCounts count_subtree(const debug::Run& run, std::int32_t step, std::int32_t node);

// The timeline: its range of steps, their screen positions, the contents of each pixel column, and
// the drawing of each row. The panel (panels/timeline.cpp) handles the mouse.

struct Ui;

/// The range chosen by the user, or the traversal.
debug::StepRange shown_steps(const State& state);

/// A range `factor` times as long, between a few steps and all of them. Step `about` keeps its
/// screen position.
debug::StepRange zoomed(const debug::StepRange& range,
                        std::int32_t about,
                        double factor,
                        std::int32_t steps);
/// Shifted by a number of steps, within the trace.
debug::StepRange moved(const debug::StepRange& range, std::int32_t by, std::int32_t steps);
/// Scrolled to a step that is outside, with some margin around it.
debug::StepRange scrolled_to(const debug::StepRange& range, std::int32_t step, std::int32_t steps);

/// Steps side by side as boxes of equal width.
struct StepAxis {
  debug::StepRange steps;
  float x = 0, width = 0;  // [px]

  float step_width() const { return width / static_cast<float>(steps.count()); }
  float begin(std::int32_t step) const {
    return x + static_cast<float>(step - steps.first) * step_width();
  }
  float middle(std::int32_t step) const { return begin(step) + step_width() / 2; }
  /// The nearest visible step.
  std::int32_t at(float screen_x) const;
};

/// Summary of the events in one column.
struct TimelineColumn {
  std::array<std::uint32_t, 5> cases{};  // nodes settled, by Case
  std::uint32_t events = 0;
  std::uint32_t found = 0, merged = 0, assigned = 0, dropped = 0, refined = 0;
  std::int32_t plane = -1;  // plane of the last event

  std::uint32_t decided() const { return cases[1] + cases[2] + cases[3] + cases[4]; }
};

/// Summarizes the events of some steps of a run in `count` columns.
std::vector<TimelineColumn> timeline_columns(const debug::Run& run,
                                             const debug::StepRange& steps,
                                             int count);
int column_of_step(std::int32_t step, const debug::StepRange& steps, int count);

/// Upper edges of the rows on screen, from top to bottom.
struct TimelineRows {
  StepAxis axis;  // shows the visible steps
  float phases = 0, marks = 0, cases = 0, planes = 0, matches = 0, end = 0;
  float overview = 0, bottom = 0;

  int columns() const { return static_cast<int>(axis.width); }
  /// All steps across the same width, for the overview.
  StepAxis whole(std::int32_t steps) const { return {{0, steps}, axis.x, axis.width}; }
};
TimelineRows timeline_rows(const Ui& ui, ImVec2 at, ImVec2 room, const debug::StepRange& shown);

/// Updates cached data of the run.
void refresh_timeline(const Ui& ui, const TimelineRows& rows);

/// Draws each phase as a band with its name.
void draw_phases(const Ui& ui, const TimelineRows& rows);
/// Draws cases and planes: a box per step if steps are wide enough, otherwise a summary per pixel
/// column.
void draw_steps(const Ui& ui, const TimelineRows& rows);
/// Draws breakpoints, bookmarks, filter matches, and the step where A and B diverge.
void draw_step_marks(const Ui& ui, const TimelineRows& rows);
/// Draws the cursor, or an arrow at the edge beyond which it is, and the step under the mouse (-1:
/// none).
void draw_step_cursor(const Ui& ui, const TimelineRows& rows, std::int32_t hovered);
/// Draws the whole trace with a frame around the visible steps.
void draw_overview(const Ui& ui, const TimelineRows& rows);

// ---- Table of planes ----------------------------------------------------------------------------

/// Unknown values are NaN.
struct PlaneRow {
  int id = 0;               // as in planes.json
  std::int32_t plane = -1;  // index in the trace
  Label label = Label::unknown;
  double area_m2 = 0, tilt_deg = 0, rms_m = 0;
  std::uint64_t points = 0;
  double support = 0;  // measured fraction of the area of its outline
  bool foot = false;   // a foot is given, so `steppable` is valid
  bool steppable = false;
  double margin = 0;  // as in planes.json; infinite if no objective was minimized
  bool undecided = false;
};

struct PlaneColumn {
  const char* name;    // in action and widget names
  const char* title;   // as short as its numbers
  const char* widest;  // widest text
  const char* meaning;
  bool largest_first;                    // at the first click
  std::string (*text)(const PlaneRow&);  // "–" if unknown
  double (*key)(const PlaneRow&);        // sort key; NaN if unknown
};
std::span<const PlaneColumn> plane_columns();
/// Filtered and sorted rows; empty while the planes are being analyzed. Each word of the filter
/// must occur in a text of the row, or in "level", "upright", "steppable", "not steppable",
/// "undecided".
std::vector<PlaneRow> plane_rows(const State& state);

/// The same rows as CSV with a header, in SI units with full precision.
std::string planes_csv(const std::vector<PlaneRow>& rows);

// ---- Texts --------------------------------------------------------------------------------------

/// The plane's number in the result, from 1; 0 before the last step, and for planes that did not
/// remain.
int finished_plane(const State& state, std::int32_t plane);

/// "steppable", "not steppable: 17 mm rough, limit 10"; empty if unknown.
std::string verdict_text(const State& state, std::int32_t plane);

/// "P1, 0.52 m2, slope 1.2 deg" and, on a second line, the verdict.
std::string describe_plane(const State& state, std::int32_t plane);

/// Area, slope, roughness, support, certainty, clearance or height of a plane; no lines if unknown.
struct PlaneLine {
  std::string name, value, meaning;
};
std::vector<PlaneLine> plane_lines(const State& state, std::int32_t plane);

/// Reasons why no step leads up to or down from a level plane.
std::vector<std::string> no_steps_of(const State& state, std::int32_t plane);

/// A flight, kerb or ramp: title, details, and its planes.
struct StairsEntry {
  std::string title;
  std::vector<std::string> lines;
  std::vector<std::int32_t> planes;  // indices in the trace
};
std::vector<StairsEntry> stairs_entries(const State& state);

// ---- Sliders -----------------------------------------------------------------------------------

/// From `low` to `high`, by ratio if logarithmic. Values outside can be typed.
struct SliderScale {
  double low = 0, high = 1;
  bool logarithmic = false;
  double standard = 0;  // default of the profile

  double share(double value) const;  // 0..1
  double value(double share) const;
};
/// A few times the default value, within the option's range.
SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile);

// ---- Histograms --------------------------------------------------------------------------------

/// Positions of values in a histogram whose bins have equal width on screen: the last bin contains
/// all outliers, and logarithmic bins cover decades.
class HistogramAxis {
 public:
  explicit HistogramAxis(const debug::Histogram& histogram) : histogram_(histogram) {}
  double share(double value) const;  // 0..1
  double value(double share) const;

 private:
  const debug::Histogram& histogram_;
};

/// Round values across the axis, ascending: 1, 2 and 5 times powers of ten, or the ends of the axis
/// if there are fewer than two.
std::vector<double> axis_ticks(const debug::Histogram& histogram);

/// The filter for values between two fractions of the axis; empty if filters do not support the
/// quantity.
std::string filter_between(const debug::Histogram& histogram, double from, double to);

// A filter input that underlines errors and shows completions below the cursor.

struct Ui;

struct FilterBox {
  std::string widget;                   // widget name
  std::string hint;                     // shown while it is empty
  std::string text;                     // from the state
  const debug::FilterProblem* problem;  // of that text; null or without a message: none
  std::string action;                   // receives the text after every key
  std::string on_enter;                 // action; empty: none
};
void draw_filter_box(const Ui& ui, const FilterBox& box, float width);

/// A filter being typed.
struct FilterBoxMemory {
  std::string text;     // follows the state until edited
  std::string applied;  // last text taken from the state
  int cursor = 0;
  int place_cursor = -1;  // where to set it once the box has keyboard focus again
  int chosen = 0;         // index of the completion
  bool take_keyboard = false, popup_hovered = false;
};

}  // namespace planescope::desktop
