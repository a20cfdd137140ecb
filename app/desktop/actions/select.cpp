// Actions to select nodes, planes and points, to measure between them, and to sort the table of
// planes.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/state/session.hpp"
#include "core/debug/explain/measure.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

// ---- Arguments ---------------------------------------------------------------------------------

PlaneRef read_plane(const State& state, const std::string& action, const std::string& text) {
  const debug::Timeline& timeline = state.run()->timeline;
  const int number = plane_number_argument(action, text, 1, timeline.greatest_number());
  const std::int32_t plane = timeline.plane_of_number(number);
  if (plane < 0) throw Error(fmt::format("action {}: there is no plane P{}", action, number));
  return {plane};
}

Pixel read_pixel(const State&, const std::string& action, const std::string& text) {
  const std::vector<double> uv = numbers_argument(action, text, 2);
  return {uv[0], uv[1]};
}

/// Pixel v * width + u; -1 outside the image.
std::int64_t source_at(const State& state, const Pixel& at) {
  const Image16& depth = state.run()->subject->frame.depth;
  const bool inside = at.u >= 0 && at.v >= 0 && at.u < depth.width && at.v < depth.height;
  return inside ? static_cast<std::int64_t>(at.v) * depth.width + static_cast<int>(at.u) : -1;
}

void check_pixel(const State& state, const std::string& action, const Pixel& at) {
  const Image16& depth = state.run()->subject->frame.depth;
  if (source_at(state, at) < 0)
    throw Error(fmt::format("action {}: {},{} is outside the {} x {} image", action, at.u, at.v,
                            depth.width, depth.height));
}

int last_voxel(const State& state) {
  return static_cast<int>(state.run()->subject->voxel_count()) - 1;
}

Clicked read_clicked(const State& state, const std::string& action, const std::string& text) {
  if (text == "nothing") return {};
  try {
    if (text.starts_with("voxel "))
      return {Clicked::On::voxel, {}, whole_argument(action, text.substr(6), 0, last_voxel(state))};
    if (text.starts_with("plane "))
      return {Clicked::On::plane, {}, read_plane(state, action, text.substr(6)).plane};
    return {Clicked::On::pixel, read_pixel(state, action, text)};
  } catch (const Error& error) {
    return {.why = error.what()};
  }
}

// ---- Selecting ---------------------------------------------------------------------------------

void select_node(State& state, std::int32_t node) {
  state.view.selected = {};
  state.view.selected.node = node;
}

/// If the result has no plane at the point, starts the search for options that produce one.
void ask_about(State& state, std::int32_t voxel) {
  const std::shared_ptr<const RunView>& view = state.results.current;
  if (!view || state.run() != view->run.get() || !view->run->is_ours()) return;
  if (view->run->segmentation.plane_of[voxel] > 0) return;
  ask_of_point(state, {.voxel = static_cast<std::uint32_t>(voxel)});
}

void select_voxel(State& state, std::int32_t voxel, std::int64_t source) {
  const debug::Timeline& timeline = state.run()->timeline;
  Selection& selected = state.view.selected;
  selected.voxel = voxel;
  selected.source = source;
  selected.node = timeline.node_of_point(voxel, state.view.step);
  selected.plane = timeline.point_at(voxel, state.view.step).plane;
  ask_about(state, voxel);
}

void select_pixel(State& state, const Pixel& at) {
  const std::int64_t source = source_at(state, at);
  const std::uint32_t voxel =
      state.run()->subject->voxel_of_source(static_cast<std::size_t>(source));
  if (voxel != planes::kNoVoxel)
    return select_voxel(state, static_cast<std::int32_t>(voxel), source);
  state.view.selected = {};
  state.view.selected.source = source;
}

void select_child(State& state) {
  const std::int32_t node = state.view.selected.node;
  if (node < 0) return;
  const debug::Run& run = *state.run();
  const std::int32_t child = run.octree().nodes[static_cast<std::size_t>(node)].first_child;
  if (child >= 0 && run.timeline.queued_at()[static_cast<std::size_t>(child)] <= state.view.step)
    select_node(state, child);
}

void select_none(State& state) {
  ViewState& view = state.view;
  const bool leaves = view.click != Click::selects || view.marking || !view.measured.empty();
  view.click = Click::selects;
  view.marking = false;
  if (!view.measured.empty()) view.message.clear();  // the measurement
  view.measured.clear();
  if (!leaves) view.selected = {};
}

/// Goes to the step at which the selected point and another one were joined in one plane, and
/// starts the search for options that keep them apart.
void show_meeting(State& state, std::int32_t other) {
  const debug::Run& run = *state.run();
  const Selection selected = state.view.selected;
  if (selected.voxel < 0) return say(state, "no point is selected: click the first of the two");
  if (!run.is_ours()) return say(state, "only method ours records merges");
  const std::int32_t step = debug::step_of_meeting(run, selected.voxel, other);
  const auto moved_on = [voxel = selected.voxel](const State& s) {
    return s.view.selected.voxel != voxel;
  };
  if (step == 0) return say_hint(state, "these two points are not on the same plane", moved_on);
  go_to_step(state, step);
  select_voxel(state, selected.voxel, selected.source);
  ask_of_point(state, {.voxel = static_cast<std::uint32_t>(selected.voxel),
                       .wish = debug::Wish::own_plane,
                       .with = other});
  state.view.inspector_tab = "inspector";
  say_hint(state, fmt::format("merged at step {}: {}", step, debug::describe_event(run, step)),
           moved_on);
}

/// "U,V" or "VOXEL".
Clicked read_other(const State& state, const std::string& action, const std::string& text) {
  if (text.find(',') == std::string::npos)
    return {Clicked::On::voxel, {}, whole_argument(action, text, 0, last_voxel(state))};
  const Pixel at = read_pixel(state, action, text);
  check_pixel(state, action, at);
  return {Clicked::On::pixel, at};
}

void show_meeting_with(State& state, const Clicked& other) {
  if (other.on == Clicked::On::voxel) return show_meeting(state, other.index);
  const std::uint32_t voxel = state.run()->subject->voxel_of_source(
      static_cast<std::size_t>(source_at(state, other.pixel)));
  if (voxel == planes::kNoVoxel) return say(state, "no measurement there");
  show_meeting(state, static_cast<std::int32_t>(voxel));
}

void show_point(State& state) {
  if (state.view.selected.voxel < 0 && state.view.selected.source < 0)
    return say_hint(
        state, "no point is selected: click one in the image or in space",
        [](const State& s) { return s.view.selected.voxel >= 0 || s.view.selected.source >= 0; });
  state.view.inspector_tab = "point";
}

void show_lost(State& state, int index) {
  const RunView& view = *state.run_view();
  const debug::Lost& lost = view.summary.lost[static_cast<std::size_t>(index)];
  state.document.marked = lost.voxels;
  if (lost.middle < 0) return;
  go_to_step(state, view.run->steps());
  const auto voxel = static_cast<std::int32_t>(lost.middle);
  const std::size_t source =
      debug::source_of_voxel(*view.run->subject, static_cast<std::uint32_t>(voxel));
  select_voxel(state, voxel, static_cast<std::int64_t>(source));
  state.view.inspector_tab = "inspector";
}

// ---- Marking -----------------------------------------------------------------------------------

/// Explains why a rectangle marked nothing new.
std::string what_is_wrong_with_a_box(std::size_t measured, std::size_t beyond) {
  if (measured == 0) return "nothing marked: no measurement there";
  if (beyond == measured)
    return "nothing marked: everything there is beyond the range; increase max_range_m";
  return "already marked";
}

void mark_pixels(State& state, const std::array<double, 4>& box) {
  const debug::Subject& subject = *state.run()->subject;
  const Image16& depth = subject.frame.depth;
  if (depth.empty()) throw Error("action mark.pixels: a cloud has no image to mark");
  std::vector<std::uint8_t> seen(subject.voxel_count(), 0);
  std::vector<std::uint32_t>& marked = state.document.marked;
  for (const std::uint32_t voxel : marked)
    if (voxel < seen.size()) seen[voxel] = 1;
  const std::size_t before = marked.size();
  std::size_t measured = 0, beyond = 0;
  const auto inside = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  for (int v = inside(std::min(box[1], box[3]), depth.height);
       v < inside(std::max(box[1], box[3]), depth.height); ++v)
    for (int u = inside(std::min(box[0], box[2]), depth.width);
         u < inside(std::max(box[0], box[2]), depth.width); ++u) {
      const std::uint16_t count = depth.at(u, v);
      if (count == 0 || count == 65535) continue;
      ++measured;
      const std::uint32_t voxel =
          subject.voxel_of_source(static_cast<std::size_t>(v) * depth.width + u);
      beyond += voxel == planes::kNoVoxel;
      if (voxel == planes::kNoVoxel || seen[voxel]) continue;
      seen[voxel] = 1;
      marked.push_back(voxel);
    }
  if (marked.size() == before) return say(state, what_is_wrong_with_a_box(measured, beyond), true);
  std::string text = counted(marked.size(), "voxel") + " marked";
  if (10 * beyond > measured)
    text += fmt::format("; {:.0f} % of what was measured there is beyond the range",
                        100.0 * static_cast<double>(beyond) / static_cast<double>(measured));
  say(state, text);
}

// ---- Measuring ---------------------------------------------------------------------------------

/// The clicked point, or the plane that contains it.
debug::MeasureEnd end_at(const State& state, const Clicked& clicked) {
  const debug::Run& run = *state.run();
  const std::int64_t index = expect_clicked(state, clicked);
  const auto at = static_cast<std::int32_t>(index);
  const std::int32_t step = state.view.step;
  if (clicked.on == Clicked::On::plane) return debug::measured_plane(run, at, step);
  const bool is_pixel = clicked.on == Clicked::On::pixel;
  const debug::MeasureEnd point =
      is_pixel ? debug::measured_point(*run.subject, static_cast<std::size_t>(index))
               : debug::measured_voxel(*run.subject, static_cast<std::uint32_t>(at));
  if (state.view.click != Click::plane) return point;
  const std::uint32_t voxel = is_pixel
                                  ? run.subject->voxel_of_source(static_cast<std::size_t>(index))
                                  : static_cast<std::uint32_t>(at);
  if (voxel == planes::kNoVoxel) throw Error("no plane there: out of range");
  const std::int32_t plane = run.timeline.point_at(static_cast<std::int32_t>(voxel), step).plane;
  return debug::measured_plane(run, plane, step, &point);
}

/// A click that hits nothing changes nothing and says so. A third click starts a new measurement.
void add_end(State& state, const Clicked& clicked) {
  std::vector<debug::MeasureEnd>& ends = state.view.measured;
  try {
    debug::MeasureEnd end = end_at(state, clicked);
    if (ends.size() == 1 && end.normal && end.name == ends[0].name && end.normal == ends[0].normal)
      throw Error(end.name + " was already clicked");
    if (ends.size() >= 2) ends.clear();
    ends.push_back(std::move(end));
  } catch (const Error& error) {
    return say(state, fmt::format("nothing to measure: {}", error.what()), true);
  }
  if (ends.size() < 2)
    return say_hint(state, "click the other end",
                    [](const State& s) { return s.view.measured.size() != 1; });
  say(state, debug::measure(*state.run()->subject, ends[0], ends[1]).text);
}

// ---- Table of planes ---------------------------------------------------------------------------

void sort_planes(State& state, int column) {
  PlanesView& view = state.view.planes;
  view.descending = view.sorted_by == column
                        ? !view.descending
                        : plane_columns()[static_cast<std::size_t>(column)].largest_first;
  view.sorted_by = column;
}

void copy_planes(State& state) {
  const std::vector<PlaneRow> rows = plane_rows(state);
  state.view.to_clipboard = planes_csv(rows);
  say(state, counted(rows.size(), "plane") + " copied as CSV");
}

}  // namespace

std::optional<std::size_t> source_of(const Selection& selected, const debug::Subject& subject) {
  if (selected.source >= 0) return static_cast<std::size_t>(selected.source);
  const auto voxel = static_cast<std::uint32_t>(selected.voxel);
  if (voxel >= subject.voxel_count()) return std::nullopt;  // -1, or of another frame
  return debug::source_of_voxel(subject, voxel);
}

ActionRow add_click(
    const ActionGroup& group, const char* name, const char* title, const char* key, Click what) {
  ActionRow row = group.add(name, title);
  row.key(key)
      .when(has_run)
      .on([what](const State& s) { return s.view.click == what; })
      .run([what](State& s) {
        s.view.click = s.view.click == what ? Click::selects : what;
        s.view.marking = false;
      });
  return row;
}

Takes<Clicked> clicked() { return {"U,V | voxel N | plane N", read_clicked}; }

const char* click_action(Click click) {
  if (click == Click::selects) return nullptr;
  if (measures(click)) return "measure.end";
  return click == Click::floor ? "gravity.floor" : "gravity.wall";
}

std::int64_t expect_clicked(const State& state, const Clicked& clicked) {
  if (clicked.on == Clicked::On::nothing)
    throw Error(clicked.why.empty() ? "no measurement there" : clicked.why);
  if (clicked.on != Clicked::On::pixel) return clicked.index;
  const Image16& depth = state.run()->subject->frame.depth;
  if (depth.empty()) throw Error("a cloud has no pixels; click one of its points in space");
  const std::int64_t source = source_at(state, clicked.pixel);
  if (source < 0)
    throw Error(fmt::format("{},{} is outside the {} x {} image", clicked.pixel.u, clicked.pixel.v,
                            depth.width, depth.height));
  return source;
}

void show_arrival(State& state, const RunArrival& arrival) {
  state.view.flash = arrival.in_a;
  if (arrival.step >= 0) go_to_step(state, arrival.step);
  Selection& selected = state.view.selected;
  if (arrival.plane >= 0) selected.plane = arrival.plane;
  if (arrival.voxel >= 0) {
    selected.voxel = arrival.voxel;
    if (selected.node < 0)
      selected.node = state.run()->timeline.node_of_point(arrival.voxel, state.view.step);
  }
  state.document.marked = arrival.marked;
  if (!arrival.message.empty()) say(state, arrival.message);
}

void add_selection_actions(std::vector<Action>& all) {
  const ActionGroup select{all, KeyMode::debugger, "Select", has_run};
  const Takes<Pixel> pixel{"U,V", read_pixel, check_pixel};
  select.add("select.node", "Select a node")
      .key("Ctrl+N")
      .run(item(
               "NODE", [](const State& s) -> auto& { return s.run()->octree().nodes; }),
           select_node);
  select.add("select.plane", "Select a plane")
      .key("Ctrl+Shift+P")
      .run(Takes<PlaneRef>{"PLANE", read_plane}, [](State& s, const PlaneRef& ref) {
        s.view.selected = {};
        s.view.selected.plane = ref.plane;
      });
  select.add("select.voxel", "Select a point by voxel")
      .key("Ctrl+Shift+U")
      .run(whole("VOXEL",
                 [](const State& s) {
                   return Range{0, last_voxel(s)};
                 }),
           [](State& s, int voxel) { select_voxel(s, voxel, -1); });
  select.add("select.pixel", "Select a point by depth pixel")
      .key("Ctrl+U")
      .run(pixel, select_pixel);
  select.add("select.parent", "Select the parent node").key("Up").run([](State& s) {
    const std::int32_t node = s.view.selected.node;
    if (node > 0) select_node(s, s.run()->octree().nodes[static_cast<std::size_t>(node)].parent);
  });
  select.add("select.child", "Select the first child node").key("Down").run(select_child);
  select.add("select.none", "Cancel, or clear the selection")
      .key("Escape")
      .when(nullptr)
      .run(select_none);
  select.add("isolate", "Isolate the selection").key("Z").flips(&ViewState::isolated);
  select.add("why.pixel", "Explain a depth pixel").run(pixel, [](State& s, const Pixel& at) {
    select_pixel(s, at);
    show_point(s);
  });
  select.add("copy", "Copy text").when(nullptr).run(text("TEXT"), [](State& s, const auto& copied) {
    s.view.to_clipboard = copied;
    say(s, "copied: " + copied);
  });
  select.add("point.life", "Show the point's history")
      .key("P")
      .words("why lost grey gray unassigned history")
      .run(show_point);
  select.add("mark.toggle", "Mark a region")
      .key("M")
      .on([](const State& s) { return s.view.marking; })
      .run([](State& s) {
        s.view.marking = !s.view.marking;
        s.view.click = Click::selects;
      });
  select.add("mark.pixels", "Mark a rectangle of pixels")
      .run(numbers<4>("U0,V0,U1,V1"), mark_pixels);
  select.add("join.show", "Show where two points were merged")
      .key("Alt+J")
      .words("why merged fused wrong merge")
      .run(Takes<Clicked>{"U,V|VOXEL", read_other}, show_meeting_with);
  select.add("point.step", "Go to a step, keep the selected point")
      .run(whole("STEP",
                 [](const State& s) {
                   return Range{0, s.run()->steps()};
                 }),
           [](State& s, int step) {
             const Selection before = s.view.selected;
             go_to_step(s, step);
             s.view.selected.voxel = before.voxel;
             s.view.selected.source = before.source;
           });
  select.add("lost.show", "Show pixels lost for one reason")
      .words("why lost grey gray unassigned missing")
      .run(item(
               "NUMBER", [](const State& s) -> auto& { return s.run_view()->summary.lost; }),
           show_lost);
  select.add("mark.clear", "Clear the marked region")
      .key("Shift+M")
      .when(nullptr)
      .run([](State& s) { s.document.marked.clear(); });
}

void add_measure_actions(std::vector<Action>& all) {
  const ActionGroup measure{all, KeyMode::debugger, "Measure", has_run};
  add_click(measure, "measure.points", "Measure between points", "U", Click::point);
  add_click(measure, "measure.planes", "Measure between planes", "Shift+U", Click::plane);
  measure.add("measure.end", "Measure from or to here").run(clicked(), add_end);

  const ActionGroup planes{all, KeyMode::debugger, "Select"};
  planes.add("planes.sort", "Sort planes")
      .run(choice<int>("id|class|area|tilt|rms|points|support|steppable|margin"), sort_planes);
  planes.add("planes.filter", "Filter planes")
      .run(text("[TEXT]"),
           [](State& s, const std::string& typed) { s.view.planes.filter = typed; });
  planes.add("planes.copy", "Copy planes as CSV")
      .key("Ctrl+Shift+C")
      .when([](const State& s) { return s.planes() != nullptr; })
      .run(copy_planes);
}

}  // namespace planescope::desktop
