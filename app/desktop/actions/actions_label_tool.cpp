// What is in the user's hand: the tool, what it paints, how large it is.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/gesture.hpp"

namespace planescope::desktop {
namespace {

constexpr double kLeastBrush_px = 1, kLargestBrush_px = 200;

struct ToolName {
  const char* name;
  const char* title;
  const char* key;
};
constexpr std::array<ToolName, 6> kTools = {{{"wand", "Plane wand", "W"},
                                             {"brush", "Brush", "B"},
                                             {"rectangle", "Rectangle", "R"},
                                             {"lasso", "Lasso", "L"},
                                             {"polygon", "Polygon", "Shift+L"},
                                             {"cut", "Cut the active plane", "Shift+S"}}};

void take_tool(State& state, LabelTool tool) {
  if (state.view.label.tool == tool) return;
  let_go(state.view.label);
  state.view.label.tool = tool;
}

Action tool_action(std::size_t index) {
  const auto tool = static_cast<LabelTool>(index);
  return {std::string("label.tool.") + kTools[index].name,
          kTools[index].title,
          "Tools",
          kTools[index].key,
          "",
          [tool](State& s, const std::string&) { take_tool(s, tool); },
          {},
          [tool](const State& s) { return s.view.label.tool == tool; }};
}

void choose_plane(State& state, int plane) {
  state.view.label.plane = plane;
  state.view.label.paints = Paints::plane;
}

/// In the order of ids, from the last one on to the first.
void step_plane(State& state, int by) {
  const std::vector<LabelPlane>& planes = state.labels()->planes;
  if (planes.empty())
    return say_hint(state, "there is no plane yet", [](const State& s) {
      const auto labels = s.labels();
      return labels && !labels->planes.empty();
    });
  const int count = static_cast<int>(planes.size());
  const auto at = std::ranges::lower_bound(planes, state.view.label.plane, {}, &LabelPlane::id);
  int index = static_cast<int>(at - planes.begin());
  const bool on_one = at != planes.end() && at->id == state.view.label.plane;
  if (by > 0)
    index = on_one ? index + 1 : index;
  else
    index -= 1;
  choose_plane(state, planes[static_cast<std::size_t>((index + count) % count)].id);
}

/// Asked for a second time, strokes paint planes again.
void paint(State& state, Paints what) {
  LabelView& view = state.view.label;
  view.paints = view.paints == what ? Paints::plane : what;
}

void set_brush(State& state, double radius_px) {
  state.view.label.brush_px = std::clamp(radius_px, kLeastBrush_px, kLargestBrush_px);
}

/// The brush, or the wand's tolerance.
void resize(State& state, double factor) {
  const LabelView& view = state.view.label;
  if (view.tool == LabelTool::wand)
    return apply(state, {"label.wand.tolerance",
                         fmt::format("{:.6g}", view.wand_options.tolerance_m * factor)});
  const double wanted = view.brush_px * factor;
  set_brush(state,
            factor > 1 ? std::max(wanted, view.brush_px + 1) : std::min(wanted, view.brush_px - 1));
}

void hover(State& state, const std::string& text) {
  LabelView& view = state.view.label;
  view.hover_hidden = 0;
  if (text == "none") {
    view.hover = -1;
    return;
  }
  view.hover = pixel_argument(state, "label.hover", text);
  if (!text.starts_with("space:") || view.tool != LabelTool::brush) return;
  LabelGesture dab = gesture_argument("label.hover", text, 1);
  dab.radius_px = static_cast<float>(view.brush_px);
  view.hover_hidden = selected_by(state, dab).hidden;
}

void pick_label(State& state) {
  const std::int64_t pixel = state.view.label.hover;
  const int plane = pixel < 0 ? 0 : state.labels()->plane.data[static_cast<std::size_t>(pixel)];
  if (plane == 0) return say(state, "no label under the mouse");
  if (plane == kPlaneIgnore) {
    state.view.label.paints = Paints::ignore;
    return say(state, "painting \"do not score\"");
  }
  choose_plane(state, plane);
  say(state, fmt::format("P{}", plane));
}

Action paint_action(
    const char* name, const char* title, const char* menu, const char* key, Paints what) {
  return {name, title,
          menu, key,
          "",   [what](State& s, const std::string&) { paint(s, what); },
          {},   [what](const State& s) { return s.view.label.paints == what; }};
}

}  // namespace

std::vector<Action> label_tool_actions() {
  const std::string tools = "Tools", planes = "Planes";
  std::vector<Action> actions;
  for (std::size_t i = 0; i < kTools.size(); ++i) actions.push_back(tool_action(i));
  std::vector<Action> more = {
      {"label.tool",
       "Choose a tool",
       "",
       "",
       "wand|brush|rectangle|lasso|polygon|cut",
       [](State& s, const std::string& text) {
         std::vector<std::string> names;
         for (const ToolName& tool : kTools) names.push_back(tool.name);
         take_tool(s, static_cast<LabelTool>(choice_argument("label.tool", text, names)));
       },
       {},
       {}},
      {"label.through",
       "Include hidden points",
       tools,
       "X",
       "",
       [](State& s, const std::string&) { s.view.label.through = !s.view.label.through; },
       {},
       [](const State& s) { return s.view.label.through; }},
      {"label.brush",
       "Brush size",
       "",
       "",
       "RADIUS in pixels",
       [](State& s, const std::string& text) {
         set_brush(s, number_argument("label.brush", text));
       },
       {},
       {}},
      {"label.smaller",
       "Smaller brush or tolerance",
       tools,
       "[",
       "",
       [](State& s, const std::string&) { resize(s, 1 / 1.25); },
       {},
       {}},
      {"label.larger",
       "Larger brush or tolerance",
       tools,
       "]",
       "",
       [](State& s, const std::string&) { resize(s, 1.25); },
       {},
       {}},
      {"label.classes",
       "Color by horizontal and vertical",
       tools,
       "C",
       "",
       [](State& s, const std::string&) { s.view.label.show_class = !s.view.label.show_class; },
       {},
       [](const State& s) { return s.view.label.show_class; }},
      {"label.plane",
       "Choose a plane",
       planes,
       "1 2 3 4 5 6 7 8 9",
       "PLANE",
       [](State& s, const std::string& text) {
         choose_plane(s, plane_argument("label.plane", text, 0, kPlaneIgnore - 1));
       },
       {},
       {}},
      {"label.plane.new",
       "New plane",
       planes,
       "N",
       "",
       [](State& s, const std::string&) { choose_plane(s, 0); },
       {},
       [](const State& s) {
         return s.view.label.plane == 0 && s.view.label.paints == Paints::plane;
       }},
      {"label.plane.next",
       "Next plane",
       planes,
       "Tab",
       "",
       [](State& s, const std::string&) { step_plane(s, 1); },
       labels_at_hand,
       {}},
      {"label.plane.previous",
       "Previous plane",
       planes,
       "Shift+Tab",
       "",
       [](State& s, const std::string&) { step_plane(s, -1); },
       labels_at_hand,
       {}},
      {"label.pick",
       "Choose the label under the mouse",
       planes,
       "P",
       "",
       [](State& s, const std::string&) { pick_label(s); },
       labels_at_hand,
       {}},
      paint_action("label.ignore", "Paint \"do not score\"", "Planes", "I", Paints::ignore),
      paint_action("label.erase", "Erase", "Planes", "0", Paints::erase),
      {"label.class_only",
       "Paint a class without a plane",
       planes,
       "",
       "h|v",
       [](State& s, const std::string& text) {
         paint(s, choice_argument("label.class_only", text, {"h", "v"}) == 0 ? Paints::h_only
                                                                             : Paints::v_only);
       },
       {},
       {}},
      {"label.hover",
       "Point at a pixel",
       "",
       "",
       "U,V or space:WxH X,Y or none",
       hover,
       labels_at_hand,
       {}},
  };
  std::ranges::move(more, std::back_inserter(actions));
  const auto plane = std::ranges::find(actions, "label.plane", &Action::name);
  plane->key_is_argument = true;
  return actions;
}

}  // namespace planescope::desktop
