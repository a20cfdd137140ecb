// Selecting nodes, planes and points, in whichever panel.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/jobs/report_arrival.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

int node_count(const debug::Run& run) { return static_cast<int>(run.octree().nodes.size()); }

void select_node(State& state, std::int32_t node) {
  state.view.selected = {};
  state.view.selected.node = node;
}

/// Where the result has no plane, the search for what would bring one begins.
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

/// Pixel v * width + u of "U,V".
std::int64_t pixel_argument(const State& state,
                            const std::string& action,
                            const std::string& text) {
  const std::vector<double> uv = numbers_argument(action, text, 2);
  const Image16& depth = state.run()->subject->frame.depth;
  if (!(uv[0] >= 0 && uv[1] >= 0 && uv[0] < depth.width && uv[1] < depth.height))
    throw Error(fmt::format("action {}: {},{} is outside the {} x {} image", action, uv[0], uv[1],
                            depth.width, depth.height));
  return static_cast<std::int64_t>(uv[1]) * depth.width + static_cast<int>(uv[0]);
}

void select_pixel(State& state, const std::string& action, const std::string& text) {
  const debug::Subject& subject = *state.run()->subject;
  const std::int64_t source = pixel_argument(state, action, text);
  const std::uint32_t voxel = subject.voxel_of_source(static_cast<std::size_t>(source));
  if (voxel != planes::kNoVoxel)
    return select_voxel(state, static_cast<std::int32_t>(voxel), source);
  state.view.selected = {};
  state.view.selected.source = source;
}

/// Of one in which nothing could be marked anew.
std::string what_is_wrong_with_a_box(std::size_t measured, std::size_t beyond) {
  if (measured == 0) return "nothing was marked: nothing was measured there";
  if (beyond == measured)
    return "nothing was marked: all of it is beyond the range, raise max_range_m";
  return "all of that is marked already";
}

void mark_pixels(State& state, const std::vector<double>& box) {
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

/// Goes to where the selected point and another one came to be in one plane, and asks what would
/// have kept them apart.
void show_meeting(State& state, std::int32_t other) {
  const debug::Run& run = *state.run();
  const Selection selected = state.view.selected;
  if (selected.voxel < 0) return say(state, "no point is selected: click the first of the two");
  if (!run.is_ours()) return say(state, "only method ours has steps at which points join");
  const std::int32_t step = debug::step_of_meeting(run, selected.voxel, other);
  if (step == 0)
    return say_hint(
        state, "these two points are not in one plane",
        [voxel = selected.voxel](const State& s) { return s.view.selected.voxel != voxel; });
  go_to_step(state, step);
  select_voxel(state, selected.voxel, selected.source);
  ask_of_point(state, {.voxel = static_cast<std::uint32_t>(selected.voxel),
                       .wish = debug::Wish::own_plane,
                       .with = other});
  state.view.inspector_tab = "inspector";
  say_hint(state, fmt::format("merged at step {}: {}", step, debug::describe_event(run, step)),
           [voxel = selected.voxel](const State& s) { return s.view.selected.voxel != voxel; });
}

void show_point(State& state) {
  if (state.view.selected.voxel < 0 && state.view.selected.source < 0)
    return say_hint(
        state, "no point is selected: click one in the image or in space",
        [](const State& s) { return s.view.selected.voxel >= 0 || s.view.selected.source >= 0; });
  state.view.inspector_tab = "point";
}

}  // namespace

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

std::vector<Action> selection_actions() {
  const std::string menu = "Select";
  return {
      {"select.node",
       "Select a node",
       menu,
       "Ctrl+N",
       "NODE",
       [](State& s, const std::string& text) {
         select_node(s, whole_argument("select.node", text, 0, node_count(*s.run()) - 1));
       },
       has_run,
       {}},
      {"select.plane",
       "Select a plane",
       menu,
       "Ctrl+Shift+P",
       "PLANE",
       [](State& s, const std::string& text) {
         const std::int32_t plane = run_plane_argument(s, "select.plane", text);
         s.view.selected = {};
         s.view.selected.plane = plane;
       },
       has_run,
       {}},
      {"select.voxel",
       "Select a point by voxel",
       menu,
       "Ctrl+Shift+U",
       "VOXEL",
       [](State& s, const std::string& text) {
         const auto voxels = static_cast<int>(s.run()->subject->voxel_count());
         select_voxel(s, whole_argument("select.voxel", text, 0, voxels - 1), -1);
       },
       has_run,
       {}},
      {"select.pixel",
       "Select a point by depth pixel",
       menu,
       "Ctrl+U",
       "U,V",
       [](State& s, const std::string& text) { select_pixel(s, "select.pixel", text); },
       has_run,
       {}},
      {"select.parent",
       "Select the parent node",
       menu,
       "Up",
       "",
       [](State& s, const std::string&) {
         const std::int32_t node = s.view.selected.node;
         if (node > 0)
           select_node(s, s.run()->octree().nodes[static_cast<std::size_t>(node)].parent);
       },
       has_run,
       {}},
      {"select.child",
       "Select the first child node",
       menu,
       "Down",
       "",
       [](State& s, const std::string&) {
         const std::int32_t node = s.view.selected.node;
         if (node < 0) return;
         const std::int32_t child =
             s.run()->octree().nodes[static_cast<std::size_t>(node)].first_child;
         if (child >= 0 &&
             s.run()->timeline.queued_at()[static_cast<std::size_t>(child)] <= s.view.step)
           select_node(s, child);
       },
       has_run,
       {}},
      {"select.none",
       "Cancel, or clear the selection",
       menu,
       "Escape",
       "",
       [](State& s, const std::string&) {
         ViewState& view = s.view;
         const bool leaves = view.click != Click::selects || view.marking || !view.measured.empty();
         view.click = Click::selects;
         view.marking = false;
         if (!view.measured.empty()) view.message.clear();  // what was measured
         view.measured.clear();
         if (!leaves) view.selected = {};
       },
       {},
       {}},
      {"isolate", "Isolate the selection", menu, "Z", "",
       [](State& s, const std::string&) { s.view.isolated = !s.view.isolated; }, has_run,
       [](const State& s) { return s.view.isolated; }},
      {"why.pixel",
       "Explain a depth pixel",
       "",
       "",
       "U,V",
       [](State& s, const std::string& text) {
         select_pixel(s, "why.pixel", text);
         show_point(s);
       },
       has_run,
       {}},
      {"copy",
       "Copy text",
       "",
       "",
       "TEXT",
       [](State& s, const std::string& text) {
         s.view.to_clipboard = text;
         say(s, "copied: " + text);
       },
       {},
       {}},
      {"point.life",
       "Show the point's history",
       menu,
       "P",
       "",
       [](State& s, const std::string&) { show_point(s); },
       has_run,
       {}},
      {"mark.toggle", "Mark a region", menu, "M", "",
       [](State& s, const std::string&) {
         s.view.marking = !s.view.marking;
         s.view.click = Click::selects;
       },
       has_run, [](const State& s) { return s.view.marking; }},
      {"mark.pixels",
       "Mark a rectangle of pixels",
       "",
       "",
       "U0,V0,U1,V1",
       [](State& s, const std::string& text) {
         mark_pixels(s, numbers_argument("mark.pixels", text, 4));
       },
       has_run,
       {}},
      {"join.show",
       "Show where two points were merged",
       menu,
       "Alt+J",
       "U,V|VOXEL",
       [](State& s, const std::string& text) {
         const debug::Subject& subject = *s.run()->subject;
         if (text.find(',') == std::string::npos)
           return show_meeting(s, whole_argument("join.show", text, 0,
                                                 static_cast<int>(subject.voxel_count()) - 1));
         const std::uint32_t voxel = subject.voxel_of_source(
             static_cast<std::size_t>(pixel_argument(s, "join.show", text)));
         if (voxel == planes::kNoVoxel) return say(s, "nothing was measured there");
         show_meeting(s, static_cast<std::int32_t>(voxel));
       },
       has_run,
       {}},
      {"point.step",
       "Go to a step, keep the selected point",
       "",
       "",
       "STEP",
       [](State& s, const std::string& text) {
         const Selection before = s.view.selected;
         go_to_step(s, whole_argument("point.step", text, 0, s.run()->steps()));
         s.view.selected.voxel = before.voxel;
         s.view.selected.source = before.source;
       },
       has_run,
       {}},
      {"lost.show",
       "Show pixels lost for one reason",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         const RunView& view = *s.run_view();
         const debug::Lost& lost = item_argument("lost.show", text, view.summary.lost);
         s.document.marked = lost.voxels;
         if (lost.middle < 0) return;
         go_to_step(s, view.run->steps());
         const auto voxel = static_cast<std::int32_t>(lost.middle);
         const std::size_t source =
             debug::source_of_voxel(*view.run->subject, static_cast<std::uint32_t>(voxel));
         select_voxel(s, voxel, static_cast<std::int64_t>(source));
         s.view.inspector_tab = "inspector";
       },
       has_run,
       {}},
      {"mark.clear",
       "Clear the marked region",
       menu,
       "Shift+M",
       "",
       [](State& s, const std::string&) { s.document.marked.clear(); },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
