// What is shown, and how.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "core/model/error.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {
namespace {

const std::vector<std::string> kColorNames = {"cases",  "planes", "labels",    "margins",
                                              "truth",  "camera", "steppable", "depth",
                                              "height", "rms",    "distance"};

Action color_action(render::ColorBy by, const std::string& title, const std::string& key) {
  const std::string& name = kColorNames[static_cast<std::size_t>(by)];
  return {"color." + name,
          title,
          "View",
          key,
          "",
          [by](State& s, const std::string&) {
            s.view.color_by = by;
            s.view.color_range.reset();
            if (s.view.case_colors == CaseColors::shown) s.view.case_colors = CaseColors::declined;
          },
          {},
          [by](const State& s) { return s.view.color_by == by; }};
}

void set_color_range(State& state, const std::string& text) {
  if (!render::is_along_scale(state.view.color_by))
    throw Error(
        "action color.range: these colours have no scale, those of color.depth, color.height, "
        "color.rms and color.distance have");
  if (text == "auto") return state.view.color_range.reset();
  const std::vector<double> ends = numbers_argument("color.range", text, 2);
  const render::ValueRange range{ends[0], ends[1]};
  if (!render::is_range(range))
    throw Error("action color.range: '" + text + "' is no range, expected its lower end first");
  state.view.color_range = range;
}

Action toggle(const std::string& name,
              const std::string& title,
              const std::string& key,
              bool ViewState::*flag) {
  Action action = {name,   title,
                   "View", key,
                   "",     [flag](State& s, const std::string&) { s.view.*flag = !(s.view.*flag); },
                   {},     [flag](const State& s) { return s.view.*flag; }};
  action.mode = KeyMode::debugger;  // what they show is drawn there alone
  return action;
}

constexpr double kPointStep = 1.25;

Action point_size_action(const std::string& name,
                         const std::string& title,
                         const std::string& key,
                         double factor) {
  Action action = {name,
                   title,
                   "View",
                   key,
                   "",
                   [factor](State& s, const std::string&) {
                     s.view.point_size =
                         std::clamp(s.view.point_size * factor, kLeastPointSize, kMostPointSize);
                     say(s, fmt::format("points of {:.2f} voxels", s.view.point_size));
                   },
                   {},
                   {}};
  action.mode = KeyMode::debugger;
  return action;
}

bool is_shown(const State& state, std::string_view panel) {
  if (panel == "image") return shows_image(state);
  return panel != "view3d" || state.view.views != Views::image;
}

void move_keyboard(State& state, int by) {
  constexpr int kCount = static_cast<int>(std::size(kDebuggerPanels));
  const auto at = std::ranges::find(kDebuggerPanels, state.view.keyboard);
  int index = at == std::end(kDebuggerPanels) ? 0 : static_cast<int>(at - kDebuggerPanels);
  do {
    index = (index + by + kCount) % kCount;
  } while (!is_shown(state, kDebuggerPanels[index]));
  state.view.keyboard = kDebuggerPanels[index];
}

Action keyboard_action(const std::string& name,
                       const std::string& title,
                       const std::string& key,
                       void (*run)(State&)) {
  return {name, title, "View",           key, "", [run](State& s, const std::string&) { run(s); },
          {},   {},    KeyMode::debugger};
}

Action in_every_mode(Action action) {
  action.mode = KeyMode::anywhere;
  return action;
}

Action tab_action(const std::string& name,
                  const std::string& title,
                  std::span<const Tab> tabs,
                  std::string& (*shown)(ViewState&)) {
  std::vector<std::string> names;
  for (const Tab& tab : tabs) names.push_back(tab.name);
  return {name,
          title,
          "",
          "",
          fmt::format("{}", fmt::join(names, "|")),
          [name, names, shown](State& s, const std::string& text) {
            choice_argument(name, text, names);
            shown(s.view) = text;
          },
          {},
          {}};
}

double* layout_share(Layout& layout, const std::string& name) {
  if (name == "left") return &layout.left;
  if (name == "right") return &layout.right;
  if (name == "bottom") return &layout.bottom;
  if (name == "image") return &layout.image;
  if (name == "octree") return &layout.octree;
  if (name == "tools") return &layout.tools;
  return nullptr;
}

void set_layout(State& state, const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string name = text.substr(0, at);
  double* share = layout_share(state.view.layout, name);
  if (!share || at == std::string::npos)
    choice_argument("layout.set", name, {"left", "right", "bottom", "image", "octree", "tools"});
  else
    *share = std::clamp(number_argument("layout.set", text.substr(at + 1)), 0.0, 0.9);
}

void set_zoom(State& state, double zoom) {
  state.view.zoom = std::clamp(zoom, 0.6, 3.0);
  say(state, fmt::format("zoom {:.0f} %", 100 * state.view.zoom));
}

}  // namespace

std::vector<Action> view_actions() {
  const std::string menu = "View";
  std::vector<Action> actions = {
      color_action(render::ColorBy::cases, "Color by case", "1"),
      color_action(render::ColorBy::planes, "Color by plane", "2"),
      color_action(render::ColorBy::labels, "Color by horizontal and vertical", "3"),
      color_action(render::ColorBy::margins, "Color by label margin", "4"),
      color_action(render::ColorBy::truth, "Color by ground truth", "5"),
      color_action(render::ColorBy::camera, "Color from the camera", "6"),
      color_action(render::ColorBy::steppable, "Color by steppable", "7"),
      color_action(render::ColorBy::depth, "Color by depth", "8"),
      color_action(render::ColorBy::height, "Color by height", "9"),
      color_action(render::ColorBy::rms, "Color by RMS", "0"),
      color_action(render::ColorBy::distance, "Color by distance to a plane", "Shift+0"),
      {"color.range",
       "Range of the color scale",
       menu,
       "",
       "LOW,HIGH in metres, or auto",
       set_color_range,
       [](const State& s) { return render::is_along_scale(s.view.color_by); },
       {}},
      toggle("show.queue", "Queued nodes", "Q", &ViewState::show_queue),
      toggle("show.settled", "Boxes of decided nodes", "B", &ViewState::show_settled),
      toggle("show.numerals", "Case numerals", "Shift+B", &ViewState::show_numerals),
      toggle("show.points", "Points", "W", &ViewState::show_points),
      toggle("show.planes", "Plane outlines", "O", &ViewState::show_planes),
      toggle("show.names", "Plane names", "Y", &ViewState::show_names),
      toggle("show.normals", "Plane normals", "V", &ViewState::show_normals),
      toggle("show.foot", "Foot space", "Shift+F", &ViewState::show_foot),
      toggle("show.stairs", "Stairs, kerbs and ramps", "Shift+T", &ViewState::show_stairs),
      toggle("show.map", "Map planes so far", "Alt+M", &ViewState::show_map),
      {"image.backdrop",
       "Color or depth image",
       menu,
       "I Shift+I",
       "",
       [](State& s, const std::string&) {
         s.view.backdrop = s.view.backdrop == render::Backdrop::color ? render::Backdrop::depth
                                                                      : render::Backdrop::color;
       },
       {},
       {}},
      {"image.edges",
       "Depth edges over color",
       menu,
       "Shift+Q",
       "",
       [](State& s, const std::string&) {
         s.view.backdrop = s.view.backdrop == render::Backdrop::edges ? render::Backdrop::color
                                                                      : render::Backdrop::edges;
       },
       {},
       [](const State& s) { return s.view.backdrop == render::Backdrop::edges; }},
      {"image.opacity",
       "Overlay opacity",
       "",
       "",
       "SHARE",
       [](State& s, const std::string& text) {
         s.view.overlay_opacity = std::clamp(number_argument("image.opacity", text), 0.0, 1.0);
       },
       {},
       {}},
      {"image.view",
       "Zoom and position of the image",
       "",
       "",
       "ZOOM,X,Y",
       [](State& s, const std::string& text) {
         const auto v = numbers_argument("image.view", text, 3);
         s.view.image_zoom = std::clamp(v[0], 1.0, 64.0);
         s.view.image_center = Vec2d(std::clamp(v[1], 0.0, 1.0), std::clamp(v[2], 0.0, 1.0));
       },
       {},
       {}},
      {"views.next",
       "Cycle views: both, scene, image",
       menu,
       "Shift+V",
       "",
       [](State& s, const std::string&) {
         s.view.views = static_cast<Views>((static_cast<int>(s.view.views) + 1) % 3);
       },
       {},
       {}},
      {"views.show",
       "Views",
       "",
       "",
       "both|scene|image",
       [](State& s, const std::string& text) {
         s.view.views =
             static_cast<Views>(choice_argument("views.show", text, {"both", "scene", "image"}));
       },
       {},
       {}},
      {"theme.toggle",
       "Light or dark theme",
       menu,
       "Ctrl+T",
       "",
       [](State& s, const std::string&) {
         s.view.theme =
             s.view.theme == render::Theme::dark ? render::Theme::light : render::Theme::dark;
       },
       {},
       {}},
      {"theme.set",
       "Theme",
       "",
       "",
       "light|dark",
       [](State& s, const std::string& text) {
         s.view.theme = choice_argument("theme.set", text, {"light", "dark"}) == 0
                            ? render::Theme::light
                            : render::Theme::dark;
       },
       {},
       {}},
      {"zoom.in",
       "Larger text",
       menu,
       "Ctrl+=",
       "",
       [](State& s, const std::string&) { set_zoom(s, s.view.zoom + 0.1); },
       {},
       {}},
      {"zoom.out",
       "Smaller text",
       menu,
       "Ctrl+-",
       "",
       [](State& s, const std::string&) { set_zoom(s, s.view.zoom - 0.1); },
       {},
       {}},
      {"zoom.set",
       "Size of text",
       "",
       "",
       "FACTOR",
       [](State& s, const std::string& text) { set_zoom(s, number_argument("zoom.set", text)); },
       {},
       {}},
      tab_action("tab.inspector", "Upper right tab", kInspectorTabs,
                 [](ViewState& view) -> std::string& { return view.inspector_tab; }),
      tab_action("tab.tool", "Lower right tab", kToolTabs,
                 [](ViewState& view) -> std::string& { return view.tool_tab; }),
      tab_action("tab.list", "Lower middle tab", kListTabs,
                 [](ViewState& view) -> std::string& { return view.list_tab; }),
      tab_action("tab.label", "Tab of the label mode", kLabelTabs,
                 [](ViewState& view) -> std::string& { return view.label.tab; }),
      {"octree.search",
       "Search the octree",
       "",
       "",
       "[FILTER]",
       [](State& s, const std::string& text) { s.view.octree_search = text; },
       {},
       {}},
      {"layout.set", "Move a splitter", "", "", "NAME=SHARE", set_layout, {}, {}},
      {"layout.reset",
       "Reset the layout",
       menu,
       "Ctrl+Shift+L",
       "",
       [](State& s, const std::string&) { s.view.layout = {}; },
       {},
       {}},
      keyboard_action("keyboard.next", "Keyboard to the next panel", "Tab",
                      [](State& s) { move_keyboard(s, 1); }),
      keyboard_action("keyboard.previous", "Keyboard to the previous panel", "Shift+Tab",
                      [](State& s) { move_keyboard(s, -1); }),
      keyboard_action("keyboard.menu", "Keyboard to the menu", "F10",
                      [](State& s) { s.view.keyboard = kMenuPanel; }),
      {"keyboard.panel",
       "Keyboard to a panel, or back to stepping",
       "",
       "",
       "[PANEL]",
       [](State& s, const std::string& panel) {
         if (!panel.empty() &&
             std::ranges::find(kDebuggerPanels, panel) == std::end(kDebuggerPanels))
           throw Error(fmt::format("action keyboard.panel: no panel '{}'; expected one of {}",
                                   panel, fmt::join(kDebuggerPanels, ", ")));
         s.view.keyboard = panel;
       },
       {},
       {},
       KeyMode::debugger},
      {"palette",
       "Find an action by name",
       menu,
       "Ctrl+P",
       "",
       [](State& s, const std::string&) {
         s.view.show_palette = !s.view.show_palette;
         s.view.palette_asks.clear();
       },
       {},
       [](const State& s) { return s.view.show_palette; }},
      {"palette.ask",
       "Enter an action's argument",
       "",
       "",
       "ACTION",
       [](State& s, const std::string& text) {
         s.view.palette_asks = find_action(text).name;
         s.view.show_palette = true;
         say(s, "");  // a reason that is shown there is of what is typed there
       },
       {},
       {}},
      point_size_action("points.larger", "Larger points", "=", kPointStep),
      point_size_action("points.smaller", "Smaller points", "-", 1 / kPointStep),
      {"picture.save",
       "Save a picture of the window",
       "File",
       "Ctrl+Shift+E",
       "PATH",
       [](State& s, const std::string& text) {
         if (!text.ends_with(".png"))
           throw Error("action picture.save: '" + text + "' is no PNG, expected a name.png");
         s.view.picture_to = text;
       },
       {},
       {}},
      in_every_mode(toggle("keys", "Keyboard shortcuts", "?", &ViewState::show_keys)),
      in_every_mode(toggle("timing", "Frame times", "F12", &ViewState::show_timing)),
  };
  return actions;
}

}  // namespace planescope::desktop
