// Where the scene is looked at from.

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

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

/// What the mouse took hold of and let go without moving it is no step.
void drop_camera(State& state) {
  CameraHistory& history = state.view.cameras;
  history.held = false;
  if (!history.before.empty() && same_place(history.before.back(), place_of(state)))
    history.before.pop_back();
}

void look_at_selected(State& state) {
  const std::vector<Vec3f> points = selected_points(state);
  if (points.empty())
    return say_hint(state, "nothing is selected that could be looked at: click it first",
                    [](const State& s) { return s.run() && !selected_points(s).empty(); });
  move_camera(state, camera_on(state, points));
}

Action preset(const std::string& name,
              const std::string& title,
              const std::string& key,
              Facing from) {
  return {name,    title,
          "View",  key,
          "",      [from](State& s, const std::string&) { move_camera(s, std::nullopt, from); },
          has_run, {}};
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

std::vector<Action> camera_actions() {
  const std::string menu = "View";
  return {
      preset("camera.home", "Frame everything", "H", Facing::home),
      preset("camera.top", "View from above", "T", Facing::top),
      preset("camera.side", "View from the side", "S", Facing::side),
      preset("camera.front", "View from the front", "Shift+S", Facing::front),
      {"camera.selected",
       "Frame the selection",
       menu,
       "F",
       "",
       [](State& s, const std::string&) { look_at_selected(s); },
       has_run,
       {}},
      {"camera.orthographic",
       "Orthographic projection",
       menu,
       "Shift+O",
       "",
       [](State& s, const std::string&) { s.view.orthographic = !s.view.orthographic; },
       {},
       [](const State& s) { return s.view.orthographic; }},
      {"camera.undo",
       "Previous camera position",
       menu,
       "Alt+Left",
       "",
       [](State& s, const std::string&) { go_to(s, s.view.cameras.before, s.view.cameras.after); },
       [](const State& s) { return !s.view.cameras.before.empty(); },
       {}},
      {"camera.redo",
       "Next camera position",
       menu,
       "Alt+Right",
       "",
       [](State& s, const std::string&) { go_to(s, s.view.cameras.after, s.view.cameras.before); },
       [](const State& s) { return !s.view.cameras.after.empty(); },
       {}},
      {"camera.set",
       "Set the camera",
       "",
       "",
       "EYE_XYZ,TARGET_XYZ",
       [](State& s, const std::string& text) {
         const auto v = numbers_argument("camera.set", text, 6);
         render::Camera camera = camera_of(s);
         camera.eye = Vec3d(v[0], v[1], v[2]);
         camera.target = Vec3d(v[3], v[4], v[5]);
         if ((camera.eye - camera.target).norm() < 1e-6)
           throw Error("action camera.set: the camera stands on its target");
         move_camera(s, camera);
       },
       has_run,
       {}},
      {"camera.hold",
       "Group camera moves into one undo step",
       "",
       "",
       "on|off",
       [](State& s, const std::string& text) {
         const bool holds = choice_argument("camera.hold", text, {"off", "on"}) == 1;
         drop_camera(s);
         if (!holds) return;
         s.view.cameras.before.push_back(place_of(s));
         s.view.cameras.held = true;
       },
       has_run,
       {}},
      {"camera.orbit",
       "Orbit the camera",
       "",
       "",
       "DEGREES_RIGHT,DEGREES_UP",
       [](State& s, const std::string& text) {
         const auto v = numbers_argument("camera.orbit", text, 2);
         move_camera(s, orbited(camera_of(s), v[0], v[1]));
       },
       has_run,
       {}},
      {"camera.pan",
       "Pan the camera",
       "",
       "",
       "RIGHT,UP in heights of the view",
       [](State& s, const std::string& text) {
         const auto v = numbers_argument("camera.pan", text, 2);
         move_camera(s, panned(camera_of(s), v[0], v[1]));
       },
       has_run,
       {}},
      {"camera.zoom",
       "Zoom the camera",
       "",
       "",
       "FACTOR",
       [](State& s, const std::string& text) {
         const render::Camera nearer = zoomed(camera_of(s), number_argument("camera.zoom", text));
         // Notches of the wheel in a row are one step.
         CameraHistory& history = s.view.cameras;
         const bool goes_on = history.zooms && !history.before.empty();
         if (goes_on)
           s.view.camera = nearer;
         else
           move_camera(s, nearer);
         history.zooms = !history.held;
       },
       has_run,
       {}},
  };
}

}  // namespace planescope::desktop
