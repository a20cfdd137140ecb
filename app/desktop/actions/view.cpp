// Actions on colors, panels, display settings and the camera.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "core/model/error.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {
namespace {

// ---- Colors ------------------------------------------------------------------------------------

using ColorRange = std::optional<render::ValueRange>;

ColorRange read_color_range(const State&, const std::string& action, const std::string& text) {
  if (text == "auto") return std::nullopt;
  const std::vector<double> ends = numbers_argument(action, text, 2);
  const render::ValueRange range{ends[0], ends[1]};
  if (!render::is_range(range))
    throw Error("action color.range: '" + text + "' is not a range; expected the lower end first");
  return range;
}

// ---- Panels ------------------------------------------------------------------------------------

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

Takes<std::string> tab_of(std::span<const Tab> tabs) {
  std::vector<std::string> names;
  for (const Tab& tab : tabs) names.push_back(tab.name);
  return one_of(fmt::format("{}", fmt::join(names, "|")));
}

LayoutShare read_share(const State&, const std::string& action, const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string name = text.substr(0, at);
  std::vector<std::string> names;
  for (const LayoutPart& part : kLayoutParts) {
    if (part.name == name && at != std::string::npos)
      return {part.share, number_argument(action, text.substr(at + 1))};
    names.emplace_back(part.name);
  }
  choice_argument(action, name, names);
  return {};
}

void set_zoom(State& state, double zoom) {
  state.view.zoom = std::clamp(zoom, 0.6, 3.0);
  say(state, fmt::format("zoom {:.0f} %", 100 * state.view.zoom));
}

void scale_points(State& state, double factor) {
  state.view.point_size =
      std::clamp(state.view.point_size * factor, kLeastPointSize, kMostPointSize);
  say(state, fmt::format("point size: {:.2f} voxels", state.view.point_size));
}

// ---- Camera ------------------------------------------------------------------------------------

CameraPlace place_of(const State& state) { return {state.view.camera, state.view.facing}; }

bool same_place(const CameraPlace& a, const CameraPlace& b) {
  if (a.camera.has_value() != b.camera.has_value()) return false;
  return a.camera ? same_camera(*a.camera, *b.camera) : a.facing == b.facing;
}

void go_to(State& state, std::vector<CameraPlace>& from, std::vector<CameraPlace>& to) {
  state.view.cameras.held = state.view.cameras.zooms = false;
  to.push_back(place_of(state));
  state.view.camera = from.back().camera;
  state.view.facing = from.back().facing;
  from.pop_back();
}

/// Releasing the camera without having moved it adds no undo step.
void hold_camera(State& state, bool holds) {
  CameraHistory& history = state.view.cameras;
  history.held = holds;
  if (!history.before.empty() && same_place(history.before.back(), place_of(state)))
    history.before.pop_back();
  if (holds) history.before.push_back(place_of(state));
}

void look_at_selected(State& state) {
  const std::vector<Vec3f> points = selected_points(state);
  if (points.empty())
    return say_hint(state, "nothing is selected; click something first",
                    [](const State& s) { return s.run() && !selected_points(s).empty(); });
  move_camera(state, camera_on(state, points));
}

/// Consecutive wheel notches are one undo step.
void zoom_camera(State& state, double factor) {
  const render::Camera nearer = zoomed(camera_of(state), factor);
  CameraHistory& history = state.view.cameras;
  if (history.zooms && !history.before.empty())
    state.view.camera = nearer;
  else
    move_camera(state, nearer);
  history.zooms = !history.held;
}

}  // namespace

void move_camera(State& state, const std::optional<render::Camera>& camera, Facing facing) {
  constexpr std::size_t kMostKept = 200;
  CameraHistory& history = state.view.cameras;
  if (!history.held && !same_place(place_of(state), {camera, facing})) {
    history.before.push_back(place_of(state));
    if (history.before.size() > kMostKept) history.before.erase(history.before.begin());
  }
  history.after.clear();
  history.zooms = false;
  state.view.camera = camera;
  state.view.facing = facing;
}

void forget_cameras(State& state) {
  state.view.camera.reset();
  state.view.facing = Facing::home;
  state.view.cameras = {};
}

void add_view_actions(std::vector<Action>& all) {
  const ActionGroup view{all, KeyMode::anywhere, "View"};
  const ActionGroup shows{all, KeyMode::debugger, "View"};  // only drawn in the debugger
  for (const ColorChoice& choice : kColorChoices)
    view.add(choice.action, choice.title)
        .key(choice.key)
        .on([by = choice.by](const State& s) { return s.view.color_by == by; })
        .run([by = choice.by](State& s) {
          s.view.color_by = by;
          s.view.range.reset();
          if (s.view.case_colors == CaseColors::shown) s.view.case_colors = CaseColors::declined;
        });
  view.add("color.range", "Range of the color scale")
      .menu()
      .when([](const State& s) { return render::is_along_scale(s.view.color_by); })
      .run(Takes<ColorRange>{"LOW,HIGH in meters, or auto", read_color_range},
           [](State& s, const ColorRange& range) { s.view.range = range; });

  shows.add("show.queue", "Queued nodes").key("Q").flips(&ViewState::show_queue);
  shows.add("show.settled", "Boxes of decided nodes").key("B").flips(&ViewState::show_settled);
  shows.add("show.numerals", "Case numerals").key("Shift+B").flips(&ViewState::show_numerals);
  shows.add("show.points", "Points").key("W").flips(&ViewState::show_points);
  shows.add("show.planes", "Plane outlines").key("O").flips(&ViewState::show_planes);
  shows.add("show.names", "Plane names").key("Y").flips(&ViewState::show_names);
  shows.add("show.normals", "Plane normals").key("V").flips(&ViewState::show_normals);
  shows.add("show.foot", "Foot space").key("Shift+F").flips(&ViewState::show_foot);
  shows.add("show.stairs", "Stairs, kerbs, and ramps")
      .key("Shift+T")
      .flips(&ViewState::show_stairs);
  shows.add("show.map", "Map planes up to this frame").key("Alt+M").flips(&ViewState::show_map);

  using render::Backdrop;
  view.add("image.backdrop", "Color or depth image").key("I Shift+I").run([](State& s) {
    s.view.backdrop = s.view.backdrop == Backdrop::color ? Backdrop::depth : Backdrop::color;
  });
  view.add("image.edges", "Depth edges over color")
      .key("Shift+Q")
      .words("alignment aligned registration")
      .on([](const State& s) { return s.view.backdrop == Backdrop::edges; })
      .run([](State& s) {
        s.view.backdrop = s.view.backdrop == Backdrop::edges ? Backdrop::color : Backdrop::edges;
      });
  view.add("image.opacity", "Overlay opacity").run(number("SHARE"), [](State& s, double share) {
    s.view.overlay_opacity = std::clamp(share, 0.0, 1.0);
  });
  view.add("image.view", "Zoom and position of the image")
      .run(numbers<3>("ZOOM,X,Y"), [](State& s, const std::array<double, 3>& v) {
        s.view.image_zoom = std::clamp(v[0], 1.0, 64.0);
        s.view.image_center = Vec2d(std::clamp(v[1], 0.0, 1.0), std::clamp(v[2], 0.0, 1.0));
      });
  view.add("views.next", "Cycle views: both, scene, image").key("Shift+V").run([](State& s) {
    s.view.views = static_cast<Views>((static_cast<int>(s.view.views) + 1) % 3);
  });
  view.add("views.show", "Views").run(choice<Views>("both|scene|image"), [](State& s, Views views) {
    s.view.views = views;
  });

  using render::Theme;
  view.add("theme.toggle", "Light or dark theme")
      .key("Ctrl+T")
      .words("dark light mode colors")
      .run([](State& s) {
        s.view.theme = s.view.theme == Theme::dark ? Theme::light : Theme::dark;
      });
  view.add("theme.set", "Theme").run(one_of("light|dark"), [](State& s, const std::string& theme) {
    s.view.theme = theme == "light" ? Theme::light : Theme::dark;
  });
  view.add("zoom.in", "Larger text").key("Ctrl+=").run([](State& s) {
    set_zoom(s, s.view.zoom + 0.1);
  });
  view.add("zoom.out", "Smaller text").key("Ctrl+-").run([](State& s) {
    set_zoom(s, s.view.zoom - 0.1);
  });
  view.add("zoom.set", "Size of text").run(number("FACTOR"), set_zoom);
  view.add("tab.inspector", "Upper right tab")
      .run(tab_of(kInspectorTabs),
           [](State& s, const std::string& tab) { s.view.inspector_tab = tab; });
  view.add("tab.tool", "Lower right tab").run(tab_of(kToolTabs), [](State& s, const auto& tab) {
    s.view.tool_tab = tab;
  });
  view.add("tab.list", "Lower middle tab").run(tab_of(kListTabs), [](State& s, const auto& tab) {
    s.view.list_tab = tab;
  });
  view.add("tab.label", "Tab of the label mode")
      .run(tab_of(kLabelTabs), [](State& s, const std::string& tab) { s.view.label.tab = tab; });
  view.add("octree.search", "Search the octree")
      .run(text("[FILTER]"), [](State& s, const std::string& t) { s.view.octree_search = t; });
  view.add("layout.set", "Move a splitter")
      .run(Takes<LayoutShare>{"NAME=SHARE", read_share}, [](State& s, const LayoutShare& one) {
        s.view.layout.*one.part = std::clamp(one.share, 0.0, 0.9);
      });
  view.add("layout.reset", "Reset the layout").key("Ctrl+Shift+L").run([](State& s) {
    s.view.layout = {};
  });

  shows.add("keyboard.next", "Focus the next panel").key("Tab").run([](State& s) {
    move_keyboard(s, 1);
  });
  shows.add("keyboard.previous", "Focus the previous panel").key("Shift+Tab").run([](State& s) {
    move_keyboard(s, -1);
  });
  shows.add("keyboard.menu", "Focus the menu").key("F10").run([](State& s) {
    s.view.keyboard = kMenuPanel;
  });
  shows.add("keyboard.panel", "Focus a panel, or return to stepping")
      .run(text("[PANEL]"), [](State& s, const std::string& panel) {
        if (!panel.empty() &&
            std::ranges::find(kDebuggerPanels, panel) == std::end(kDebuggerPanels))
          throw Error(fmt::format("action keyboard.panel: no panel '{}'; expected one of {}", panel,
                                  fmt::join(kDebuggerPanels, ", ")));
        s.view.keyboard = panel;
      });
  view.add("palette", "Find an action by name")
      .key("Ctrl+P")
      .on([](const State& s) { return s.view.show_palette; })
      .run([](State& s) {
        s.view.show_palette = !s.view.show_palette;
        s.view.palette_asks.clear();
      });
  view.add("palette.ask", "Enter an action's argument")
      .run(text("ACTION"), [](State& s, const std::string& name) {
        s.view.palette_asks = find_action(name).name;
        s.view.show_palette = true;
        say(s, "");  // clear a reason that refers to earlier input
      });
  constexpr double kPointStep = 1.25;
  shows.add("points.larger", "Larger points").key("=").run([](State& s) {
    scale_points(s, kPointStep);
  });
  shows.add("points.smaller", "Smaller points").key("-").run([](State& s) {
    scale_points(s, 1 / kPointStep);
  });
  view.add("picture.save", "Save a picture of the window")
      .key("Ctrl+Shift+E")
      .menu("File")
      .words("screenshot export png")
      .run(text("PATH"), [](State& s, const std::string& path) {
        if (!path.ends_with(".png"))
          throw Error("action picture.save: '" + path +
                      "' is not a PNG file; expected a name that ends in .png");
        s.document.check_output(path);
        s.view.picture_to = path;
      });
  view.add("keys", "Keyboard shortcuts")
      .key("?")
      .words("help shortcuts keyboard")
      .flips(&ViewState::show_keys);
  view.add("timing", "Frame times").key("F12").flips(&ViewState::show_timing);
}

void add_camera_actions(std::vector<Action>& all) {
  const ActionGroup camera{all, KeyMode::anywhere, "View", has_run};
  const auto add_preset = [&](const char* name, const char* title, const char* key, Facing from,
                              const char* words) {
    camera.add(name, title).key(key).words(words).run([from](State& s) {
      move_camera(s, std::nullopt, from);
    });
  };
  add_preset("camera.home", "Frame everything", "H", Facing::home, "look all reset");
  add_preset("camera.top", "View from above", "T", Facing::top, "look above");
  add_preset("camera.side", "View from the side", "S", Facing::side, "look");
  add_preset("camera.front", "View from the front", "Shift+S", Facing::front, "look");
  camera.add("camera.selected", "Frame the selection")
      .key("F")
      .words("look zoom selected")
      .run(look_at_selected);
  camera.add("camera.orthographic", "Orthographic projection")
      .key("Shift+O")
      .words("flat perspective")
      .when(nullptr)
      .flips(&ViewState::orthographic);
  camera.add("camera.undo", "Previous camera position")
      .key("Alt+Left")
      .words("undo view")
      .when([](const State& s) { return !s.view.cameras.before.empty(); })
      .run([](State& s) { go_to(s, s.view.cameras.before, s.view.cameras.after); });
  camera.add("camera.redo", "Next camera position")
      .key("Alt+Right")
      .when([](const State& s) { return !s.view.cameras.after.empty(); })
      .run([](State& s) { go_to(s, s.view.cameras.after, s.view.cameras.before); });
  camera.add("camera.set", "Set the camera")
      .run(numbers<6>("EYE_XYZ,TARGET_XYZ"), [](State& s, const std::array<double, 6>& v) {
        render::Camera at = camera_of(s);
        at.eye = Vec3d(v[0], v[1], v[2]);
        at.target = Vec3d(v[3], v[4], v[5]);
        if ((at.eye - at.target).norm() < 1e-6)
          throw Error("action camera.set: eye and target are the same point");
        move_camera(s, at);
      });
  camera.add("camera.hold", "Group camera moves into one undo step")
      .run(one_of("on|off"), [](State& s, const std::string& on) { hold_camera(s, on == "on"); });
  using TwoNumbers = std::array<double, 2>;
  camera.add("camera.orbit", "Orbit the camera")
      .run(numbers<2>("DEGREES_RIGHT,DEGREES_UP"), [](State& s, const TwoNumbers& deg) {
        move_camera(s, orbited(camera_of(s), deg[0], deg[1]));
      });
  camera.add("camera.pan", "Pan the camera")
      .run(numbers<2>("RIGHT,UP in heights of the view"), [](State& s, const TwoNumbers& by) {
        move_camera(s, panned(camera_of(s), by[0], by[1]));
      });
  camera.add("camera.zoom", "Zoom the camera").run(number("FACTOR"), zoom_camera);
}

}  // namespace planescope::desktop
