#pragma once

// The interface of panels: the state to read, commands to emit, widget names and colors. Panels are
// free functions that draw into the current ImGui window.

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

/// Rectangles of widgets in the last frame, by name: "octree.node.12", "criteria.theta_n_out".
struct WidgetRect {
  ImVec2 min, max;
};
using Widgets = std::map<std::string, WidgetRect>;

/// Colors in addition to ImGui's style.
struct UiColors {
  ImU32 text, muted, accent, good, bad, warning, grid, panel;
};

/// Steps at which breakpoints stop; cached until the breakpoints or the run change.
struct BreakpointStops {
  std::weak_ptr<const debug::Run> run;
  std::vector<Breakpoint> breakpoints;
  std::vector<std::int32_t> on, off;  // steps of enabled and disabled breakpoints, ascending
};

/// Groups of the event list, cached per run, and those that are open.
struct EventGroups {
  std::weak_ptr<const debug::Run> run;
  std::vector<EventRow> rows;
  std::set<std::int32_t> open;  // by first step
};

/// Contents of the timeline, cached until the run, the range or the width changes, and the state of
/// dragging.
struct TimelineMemory {
  std::weak_ptr<const debug::Run> run;
  std::vector<debug::Phase> phases;
  std::vector<TimelineColumn> columns, overview;  // for the visible steps and for all steps
  debug::StepRange steps;                         // range of `columns`
  std::int32_t grabbed = 0;     // first visible step at drag start; on the overview, from the mouse
  int button = 0;               // mouse button of the drag
  bool double_clicked = false;  // and still held
};

/// Contents of the point panel, cached per point and run.
struct PointHistory {
  std::shared_ptr<const io::Recording> recording;
  std::shared_ptr<const RunView> of;
  std::int64_t source = -1;
  std::vector<debug::HistoryEvent> life;
  debug::WhyNot why;
};

/// The Inspector's explanation of a point's result; cached like PointStory.
struct PointAnswer {
  std::weak_ptr<const debug::Run> of;
  std::size_t source = 0;
  debug::WhyNot why;
};

/// Camera presets for a recording, found once.
struct CameraForm {
  std::shared_ptr<const io::Recording> of;
  std::vector<io::CameraChoice> choices;
};

/// A stroke on labels until the mouse button is released.
struct LabelDrag {
  bool on = false;
  DrawnIn where = DrawnIn::image;
  labels::PaintMode mode = labels::PaintMode::over;
  std::vector<labels::Vec2f> path;
  bool ignore_release = false;  // of a double click, whose first click was already handled
};

/// Current or last mouse position in a label view.
struct LabelPointing {
  bool now = false;
  DrawnIn where = DrawnIn::space;
  labels::Vec2f at = labels::Vec2f::Zero();
};

/// Positions of plane names, cached per labels.
struct LabelNames {
  std::shared_ptr<const FrameLabels> of;
  std::vector<render::LabelPlace> places;
};

/// Facts about a frame's planes that FrameLabels does not contain.
struct PlaneFacts {
  std::size_t pixels = 0;
  double area_m2 = 0;
};
struct LabelFacts {
  labels::LabelStatistics statistics;
  std::vector<PlaneFacts> planes;  // in the order of FrameLabels::planes
};

/// Cached per labels.
struct KeptLabelFacts {
  std::weak_ptr<const FrameLabels> of;
  LabelFacts facts;
};

/// The item under the mouse in a view.
struct PointedAt {
  render::Picked what = {};
  std::int64_t source = -1;  // depth pixel v * width + u; -1 if there is none
};

/// Text being typed and other state local to panels.
struct PanelMemory {
  std::map<std::string, FilterBoxMemory> filter_boxes;  // by widget
  std::map<std::int32_t, bool> octree_open;             // nodes opened or closed by the user
  std::string palette_text;
  int palette_index = 0;
  std::map<std::string, std::string> texts;  // by widget
  std::map<std::string, double> numbers;     // by widget
  BreakpointStops breakpoint_stops;
  EventGroups events;
  TimelineMemory timeline;
  PointHistory point;
  PointAnswer answer;
  KeptLabelFacts label_facts;
  debug::Histogram grabbed;  // before its threshold was dragged
  CameraForm camera_form;
  LabelDrag label_drag;
  LabelNames label_names;
  LabelPointing label_pointing;
  PointedAt context;  // of the open context menu
  std::int32_t events_scrolled_to = -1, octree_scrolled_to = -1;
};

/// Statistics of recent frames.
struct FrameTimes {
  double last_ms = 0, median_ms = 0, p99_ms = 0;
};

struct Ui {
  const State& state;
  std::vector<Command>& commands;
  Widgets& widgets;
  PanelMemory& memory;
  Canvas* canvas;  // null without GL
  UiColors colors;
  float scale = 1;  // of the screen and the user's zoom: 1 = 15 px text
  ImFont* small = nullptr;
  ImFont* bold = nullptr;
  FrameTimes timing = {};

  void act(std::string action) const { commands.push_back({std::move(action)}); }
  template <typename T>
  void act(std::string action, const T& value) const {
    commands.push_back(command(std::move(action), value));
  }
  /// Names the last drawn item.
  void name(const std::string& widget) const;
  /// Names an area in screen coordinates.
  void name(const std::string& widget, ImVec2 min, ImVec2 max) const;
  float px(float at_scale_1) const { return at_scale_1 * scale; }
};

const BreakpointStops& stops_of(const Ui& ui);

/// Sets ImGui's style for a theme and scales all sizes.
void set_style(render::Theme theme, float scale);
UiColors ui_colors(render::Theme theme);

}  // namespace planescope::desktop
