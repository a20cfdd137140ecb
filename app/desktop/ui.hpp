#pragma once

// What a panel is given: the state to read, a place for the commands it makes, names for its
// widgets, colours. Panels are free functions; they draw into the ImGui window that is open.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/imgui.hpp"
#include "app/desktop/look.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/labels/review/audit.hpp"

namespace planescope::desktop {

/// Where a widget stood in the last frame, by name: "octree.node.12", "criteria.theta_n_out".
struct WidgetRect {
  ImVec2 min, max;
};
using Widgets = std::map<std::string, WidgetRect>;

/// Colours beside ImGui's own style.
struct UiColors {
  ImU32 text, muted, accent, good, bad, warning, grid, panel;
};

/// Where breakpoints stop, kept while neither they nor the run change.
struct BreakpointStops {
  std::weak_ptr<const debug::Run> run;
  std::vector<Breakpoint> breakpoints;
  std::vector<std::int32_t> on, off;  // steps, ascending: of those that are enabled, and not
};

/// The event list's groups, kept while the run is the same, and which of them are open.
struct EventGroups {
  std::weak_ptr<const debug::Run> run;
  std::vector<EventRow> rows;
  std::set<std::int32_t> open;  // by first step
};

/// What the timeline draws, kept while the run, the range and the width are the same, and the mouse
/// on it.
struct TimelineMemory {
  std::weak_ptr<const debug::Run> run;
  std::vector<debug::Phase> phases;
  std::vector<TimelineColumn> columns, overview;  // of the steps shown, of all steps
  debug::StepRange steps;                         // that `columns` are of
  std::int32_t grabbed = 0;  // first step shown when a drag began; on the overview, from the mouse
  int button = 0;            // that drags
  bool double_clicked = false;  // and not let go yet
};

/// What the point panel tells, kept until another point or run is looked at.
struct PointStory {
  std::shared_ptr<const io::Recording> recording;
  std::shared_ptr<const RunView> of;
  std::int64_t source = -1;
  std::vector<debug::HistoryEvent> life;
  debug::WhyNot why;
};

/// Why a point is where it is, for the Inspector's answer; kept as PointStory.
struct PointAnswer {
  std::weak_ptr<const debug::Run> of;
  std::size_t source = 0;
  debug::WhyNot why;
};

/// What a user may choose from for a recording's camera, found once.
struct CameraForm {
  std::shared_ptr<const io::Recording> of;
  std::vector<io::CameraChoice> choices;
};

/// What is being drawn on labels, until the mouse lets go.
struct LabelDrag {
  bool on = false;
  DrawnIn where = DrawnIn::image;
  labels::PaintMode mode = labels::PaintMode::over;
  std::vector<labels::Vec2f> path;
  bool ignore_release = false;  // of a double click: its first click did everything
};

/// Where the mouse is, or was last, in a view of labels.
struct LabelPointing {
  bool now = false;
  DrawnIn where = DrawnIn::space;
  labels::Vec2f at = labels::Vec2f::Zero();
};

/// Where planes' names stand, kept while the labels are the same.
struct LabelNames {
  std::shared_ptr<const FrameLabels> of;
  std::vector<render::LabelPlace> places;
};

/// What panels tell of a frame's planes beyond what their list has.
struct PlaneFacts {
  std::size_t pixels = 0;
  double area_m2 = 0;
};
struct LabelFacts {
  labels::LabelStatistics statistics;
  std::vector<PlaneFacts> planes;  // as FrameLabels::planes
};

/// Kept while the labels stay as they are.
struct KeptLabelFacts {
  std::weak_ptr<const FrameLabels> of;
  LabelFacts facts;
};

/// What the mouse points at in a view.
struct PointedAt {
  render::Picked what = {};
  std::int64_t source = -1;  // depth pixel v * width + u, where it is one
};

/// Text being typed and other state that only panels have.
struct PanelMemory {
  std::map<std::string, FilterBoxMemory> filter_boxes;  // by widget
  std::map<std::int32_t, bool> octree_open;             // nodes that the user opened or closed
  std::string palette_text;
  int palette_index = 0;
  std::map<std::string, std::string> texts;  // by widget
  std::map<std::string, double> numbers;     // by widget
  BreakpointStops breakpoint_stops;
  EventGroups events;
  TimelineMemory timeline;
  PointStory point;
  PointAnswer answer;
  KeptLabelFacts label_facts;
  debug::Histogram grabbed;  // as it was when its threshold was taken hold of
  CameraForm camera_form;
  LabelDrag label_drag;
  LabelNames label_names;
  LabelPointing label_pointing;
  PointedAt context;  // of the menu that is open
  std::int32_t events_scrolled_to = -1, octree_scrolled_to = -1;
};

/// Of the frames drawn lately.
struct FrameTimes {
  double last_ms = 0, median_ms = 0, p99_ms = 0;
};

struct Ui {
  const State& state;
  std::vector<Command>& commands;
  Widgets& widgets;
  PanelMemory& memory;
  Canvas* canvas;  // null where there is no GL
  UiColors colors;
  float scale = 1;  // of the screen and the user: 1 = 15 px text
  ImFont* small = nullptr;
  ImFont* bold = nullptr;
  FrameTimes timing = {};

  void act(std::string action) const { commands.push_back({std::move(action)}); }
  template <typename T>
  void act(std::string action, const T& value) const {
    commands.push_back(command(std::move(action), value));
  }
  /// Names the item drawn last.
  void name(const std::string& widget) const;
  /// Names a part of the window: coordinates of the screen.
  void name(const std::string& widget, ImVec2 min, ImVec2 max) const;
  float px(float at_scale_1) const { return at_scale_1 * scale; }
};

const BreakpointStops& stops_of(const Ui& ui);

/// ImGui's style and colours for a theme, in one size of everything.
void set_style(render::Theme theme, float scale);
UiColors ui_colors(render::Theme theme);

}  // namespace planescope::desktop
