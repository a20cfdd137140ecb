// Planes over all frames: following them, and going to where one is or is missing.

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

bool has_map(const State& state) { return state.map() != nullptr; }
bool has_track(const State& state) {
  return state.map() && state.map()->track(state.view.tracks.track);
}

void follow_planes(State& state, const std::string&) {
  const OpenRecording* open = state.document.current();
  if (open->recording->info().width == 0)
    throw Error("action map.make: the recording is of clouds, planes are followed in depth images");
  if (!open->recording->info().knows_camera())
    throw Error("action map.make: the recording has no camera intrinsics");
  state.results.map.running = true;
  state.results.map.begun = false;
  state.results.map.done = state.results.map.total = 0;
  state.results.map.stage = "begins";
  state.view.list_tab = "tracks";
}

void stop_following(State& state, const std::string&) {
  state.results.map.running = false;
  say(state, "tracking canceled");
}

/// In another world, which stands upright as well.
render::Camera carried(render::Camera camera, const Pose& T) {
  camera.eye = T * camera.eye;
  camera.target = T * camera.target;
  return camera;
}

/// Shows a track in a frame, from where the scene is looked at now.
void show_track(State& state, int id, int frame) {
  const RunView* view = state.run_view();
  std::optional<render::Camera> camera;
  if (view && state.view.camera)
    if (const std::optional<Pose> T = T_map_scene(*state.map(), *view->run))
      camera = carried(*state.view.camera, *T);
  state.view.tracks.track = id;
  state.view.list_tab = "tracks";
  if (frame != state.document.frame) {
    apply(state, {"frame.show", std::to_string(frame)});
    state.view.tracks.place = TrackPlace{id, frame, camera};
  } else if (view && view->map) {
    go_to_track(state, {id, frame, {}});
  }
}

void show_track_action(State& state, const std::string& text) {
  constexpr const char* kName = "track.show";
  const std::size_t comma = text.find(',');
  std::string name = text.substr(0, comma);
  if (name.starts_with('T') || name.starts_with('t')) name = name.substr(1);
  const auto count = static_cast<int>(state.map()->tracker().tracks().size());
  const int id = whole_argument(kName, name, 1, count);
  if (!state.map()->track(id))
    throw Error(fmt::format("action track.show: T{} became T{}", id,
                            world::final_track(state.map()->tracker().tracks(), id)));
  const auto [first, last] = state.map()->frames();
  show_track(state, id,
             comma == std::string::npos
                 ? state.document.frame
                 : whole_argument(kName, text.substr(comma + 1), first, last));
}

using Find = int (*)(const MapView&, const world::Track&, int from, int direction);

/// To another frame of the selected track.
Action to_frame(const char* name,
                const char* title,
                const char* key,
                Find find,
                int direction,
                const char* none) {
  return {name,
          title,
          "Tracks",
          key,
          "",
          [=](State& s, const std::string&) {
            const int id = s.view.tracks.track;
            const int frame = find(*s.map(), *s.map()->track(id), s.document.frame, direction);
            if (frame < 0) return say_nothing_done(s, fmt::format("T{} {}", id, none));
            show_track(s, id, frame);
          },
          has_track,
          {}};
}

void set_track_filter(State& state, const std::string& text) {
  TracksView& view = state.view.tracks;
  view.filter = text;
  view.filter_problem.clear();
  try {
    world::TrackFilter{text};
  } catch (const Error& error) {
    view.filter_problem = error.what();
  }
}

}  // namespace

void go_to_track(State& state, const TrackPlace& place) {
  const RunView& view = *state.results.current;
  show_arrival(state, arrival_at_track(*view.map, place.track, *view.run));
  const std::optional<Pose> T = T_map_scene(*view.map, *view.run);
  if (place.camera && T) move_camera(state, carried(*place.camera, T->inverse()));
}

std::vector<Action> map_actions() {
  const std::string menu = "Tracks";
  const auto running = [](const State& s) { return s.results.map.running; };
  return {
      {"map.make",
       "Track planes over all frames",
       menu,
       "Ctrl+Shift+M",
       "",
       follow_planes,
       [=](const State& s) { return s.document.current() && !running(s); },
       {}},
      {"map.stop", "Stop tracking", menu, "Alt+K", "", stop_following, running, {}},
  };
}

std::vector<Action> track_actions() {
  return {
      to_frame("track.previous", "Previous frame of the track", "Alt+PageUp", frame_seen, -1,
               "is not in an earlier frame"),
      to_frame("track.next", "Next frame of the track", "Alt+PageDown", frame_seen, 1,
               "is not in a later frame"),
      to_frame("track.gap.previous", "Previous gap of the track", "Shift+PageUp", frame_missed, -1,
               "is not missed in an earlier frame"),
      to_frame("track.gap.next", "Next gap of the track", "Shift+PageDown", frame_missed, 1,
               "is not missed in a later frame"),
      {"track.show", "Show a track", "", "", "TRACK[,FRAME]", show_track_action, has_map, {}},
      {"track.filter", "Filter the tracks", "", "", "[FILTER]", set_track_filter, {}, {}},
      {"track.color",
       "Color tracks by",
       "",
       "",
       "track|area|rms",
       [](State& s, const std::string& text) {
         s.view.tracks.color_by = static_cast<TrackColor>(
             choice_argument("track.color", text, {"track", "area", "rms"}));
       },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
