// Tracked planes of a recording in the window, and the actions that use them.

#include "app/desktop/tracks/map_view.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/commands/map_picture.hpp"
#include "app/desktop/actions/actions.hpp"
#include "app/desktop/jobs/jobs.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/model/error.hpp"
#include "core/world/tracks/tracker.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

using world::Moment;

/// The voxels of a run on the track, ascending.
std::vector<std::uint32_t> voxels_of(const MapView& view,
                                     world::Track track,
                                     const debug::Run& run) {
  const debug::Subject& subject = *run.subject;
  const world::CameraPose* pose = view.pose(subject.frame.index);
  if (!pose) return {};
  world::ObservedFrame frame;
  frame.T_world_camera = pose->T_world_camera;
  frame.intrinsics = subject.frame.intrinsics;
  frame.depth = subject.frame.depth;
  frame.depth_unit_m = subject.frame.depth_unit_m;
  frame.max_range_m = run.options.cloud.max_range_m;
  frame.noise = run.segmentation.noise;
  frame.plane_of = Image16(frame.depth.width, frame.depth.height);
  std::vector<std::uint32_t> pixels, voxels;
  world::visibility_of(track, frame, view.tracker().options(), &pixels);
  for (const std::uint32_t pixel : pixels)
    if (const std::uint32_t voxel = subject.voxel_of_source(pixel); voxel != planes::kNoVoxel)
      voxels.push_back(voxel);
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

template <typename Is>
int frame_where(const MapView& view, int from, int direction, const Is& is) {
  const auto [first, last] = view.frames();
  for (int frame = from + direction; frame >= first && frame <= last; frame += direction)
    if (is(frame)) return frame;
  return -1;
}

}  // namespace

const world::Track* MapView::track(int id) const {
  if (id < 1 || id > std::ssize(tracker().tracks())) return nullptr;
  const world::Track& track = tracker().tracks()[static_cast<std::size_t>(id) - 1];
  return track.state == world::TrackState::merged ? nullptr : &track;
}

const world::CameraPose* MapView::pose(int frame) const { return world::pose_of(map.poses, frame); }

const world::FrameOfTracks* MapView::tracks_at(int frame) const {
  const auto& all = tracker().frames();
  const auto at = std::ranges::lower_bound(all, frame, {}, &world::FrameOfTracks::frame);
  return at != all.end() && at->frame == frame ? &*at : nullptr;
}

std::pair<int, int> MapView::frames() const {
  const auto& all = tracker().frames();
  return all.empty() ? std::pair{0, -1} : std::pair{all.front().frame, all.back().frame};
}

void complete(MapView& view) {
  for (const world::Track& track : view.tracker().tracks()) {
    const bool held = track.is_sure(view.tracker().options());
    planes::Outline& outline = view.outlines.emplace_back();
    if (held) outline = world::outline_of(track);
    view.area_m2.push_back(outline.area_m2);
  }
  view.colors = app::colors_of_tracks(view.tracker());
}

bool is_fresh(const MapView& view, const Document& document) {
  const OpenRecording* open = document.current();
  return open && view.recording == open->recording && view.picked == open->picked &&
         view.key == run_key(document.options);
}

std::vector<const world::Track*> track_rows(const State& state) {
  std::vector<const world::Track*> rows;
  const MapView* view = state.map();
  if (!view) return rows;
  const TracksView& shown = state.view.tracks;
  const world::TrackFilter filter(shown.filter_problem.empty() ? shown.filter : "");
  for (const world::Track& track : view->tracker().tracks())
    if (track.state != world::TrackState::merged && filter.matches(view->tracker(), track))
      rows.push_back(&track);
  std::ranges::stable_sort(rows, {}, &world::Track::born);
  return rows;
}

std::string track_text(const State& state) {
  const MapView* view = state.map();
  const world::Track* track = view ? view->track(state.view.tracks.track) : nullptr;
  return track ? world::moment_text(view->tracker(), *track, state.document.frame) : "";
}

int frame_seen(const MapView& view, const world::Track& track, int from, int direction) {
  return frame_where(view, from, direction, [&](int frame) {
    return world::moment_of(track, frame).kind == Moment::Kind::seen;
  });
}

int frame_missed(const MapView& view, const world::Track& track, int from, int direction) {
  return frame_where(view, from, direction,
                     [&](int frame) { return world::moment_of(track, frame).is_unlisted(); });
}

std::vector<int> colors_by_track(const MapView& view, const debug::Run& run) {
  const world::FrameOfTracks* tracked = view.tracks_at(run.subject->frame.index);
  if (!tracked || tracked->listed != std::ssize(run.segmentation.planes)) return {};
  std::vector<int> colors;
  for (std::size_t k = 0; k < run.segmentation.planes.size(); ++k) {
    const int track = tracked->track_of[k];
    const int now = track > 0 ? world::final_track(view.tracker().tracks(), track) : 0;
    colors.push_back(now > 0 ? view.colors[static_cast<std::size_t>(now) - 1] : 0);
  }
  return colors;
}

std::optional<Pose> T_map_scene(const MapView& view, const debug::Run& run) {
  const world::CameraPose* pose = view.pose(run.subject->frame.index);
  if (!pose) return std::nullopt;
  const planes::Cloud& cloud = run.subject->prepared.cloud;
  Pose shift = Pose::Identity();
  shift.translation() = cloud.origin;
  return pose->T_world_camera * cloud.T_world_sensor.inverse() * shift;
}

std::vector<render::DrawLines> map_lines(const MapView& view, const debug::Run& run) {
  std::vector<render::DrawLines> all;
  const std::optional<Pose> T = T_map_scene(view, run);
  if (!T) return all;
  const Pose T_scene_map = T->inverse();
  const int frame = run.subject->frame.index;
  for (const world::Track& track : view.tracker().tracks()) {
    const planes::Outline& in_map = view.outlines[static_cast<std::size_t>(track.id) - 1];
    if (in_map.parts.empty() || track.born > frame) continue;
    const planes::Outline outline = planes::moved(in_map, T_scene_map);
    render::DrawLines lines;
    lines.positions = render::plane_shapes(std::span(&outline, 1), Vec3d::Zero()).front().rings;
    lines.colors.assign(lines.positions.size() / 2,
                        render::plane_color(view.colors[static_cast<std::size_t>(track.id) - 1]));
    lines.width_px = 2;
    lines.lifted = true;
    all.push_back(std::move(lines));
  }
  return all;
}

RunArrival arrival_at_track(const MapView& view, int id, const debug::Run& run) {
  RunArrival arrival;
  const world::Track* track = view.track(id);
  if (!track) return arrival;
  const int frame = run.subject->frame.index;
  const Moment moment = world::moment_of(*track, frame);
  arrival.message = world::moment_text(view.tracker(), *track, frame);
  const auto select = [&](int plane) {
    if (plane >= 1 && plane <= std::ssize(run.segmentation.planes))
      arrival.plane = run.timeline.plane_of_number(plane);
  };
  if (moment.sighting && !moment.sighting->minor) {
    select(moment.sighting->plane);
    return arrival;
  }
  arrival.marked = voxels_of(view, *track, run);
  if (moment.gap && moment.gap->why == world::Absence::not_matched) {
    select(debug::plane_of_region(run, arrival.marked));
    return arrival;
  }
  if (arrival.marked.empty()) return arrival;
  arrival.voxel = static_cast<std::int32_t>(arrival.marked[arrival.marked.size() / 2]);
  const debug::RegionDecision loss = debug::loss_of_region(run, arrival.marked);
  if (loss.step == 0) return arrival;
  arrival.step = loss.step;
  arrival.voxel = loss.voxel;
  arrival.message += fmt::format(": unassigned at step {}, {} of its {} voxels", loss.step,
                                 loss.points, arrival.marked.size());
  return arrival;
}

// ---- Actions: tracking planes, going to frames where one is seen or missed ----------------------

namespace {

bool has_track(const State& state) {
  return state.map() && state.map()->track(state.view.tracks.track);
}

void follow_planes(State& state) {
  const OpenRecording* open = state.document.current();
  if (open->recording->info().width == 0)
    throw Error(
        "action map.make: the recording contains point clouds; planes can be tracked only in depth "
        "images");
  if (!open->recording->info().knows_camera())
    throw Error("action map.make: the recording has no camera intrinsics");
  static_cast<Asked&>(state.results.map) = {.running = true, .stage = "begins"};
  state.view.list_tab = "tracks";
}

void stop_following(State& state) {
  state.results.map.running = false;
  say(state, "tracking canceled");
}

/// Transforms a camera between two upright worlds.
render::Camera carried(render::Camera camera, const Pose& T) {
  camera.eye = T * camera.eye;
  camera.target = T * camera.target;
  return camera;
}

/// Shows a track in a frame from the current camera position.
void show_track(State& state, int id, int frame) {
  const RunView* view = state.run_view();
  std::optional<render::Camera> camera;
  if (view && state.view.camera)
    if (const std::optional<Pose> T = T_map_scene(*state.map(), *view->run))
      camera = carried(*state.view.camera, *T);
  state.view.tracks.track = id;
  state.view.list_tab = "tracks";
  if (frame != state.document.frame) {
    show_frame(state, frame);
    state.view.tracks.place = TrackPlace{id, frame, camera};
  } else if (view && view->map) {
    go_to_track(state, {id, frame, {}});
  }
}

TrackFrame read_track(const State& state, const std::string& action, const std::string& text) {
  const std::size_t comma = text.find(',');
  std::string name = text.substr(0, comma);
  if (name.starts_with('T') || name.starts_with('t')) name = name.substr(1);
  const auto count = static_cast<int>(state.map()->tracker().tracks().size());
  TrackFrame read{whole_argument(action, name, 1, count)};
  if (!state.map()->track(read.track))
    throw Error(fmt::format("action {}: T{} became T{}", action, read.track,
                            world::final_track(state.map()->tracker().tracks(), read.track)));
  const auto [first, last] = state.map()->frames();
  if (comma != std::string::npos)
    read.frame = whole_argument(action, text.substr(comma + 1), first, last);
  return read;
}

using Find = int (*)(const MapView&, const world::Track&, int from, int direction);

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

void add_track_actions(std::vector<Action>& all) {
  const ActionGroup map{all, KeyMode::anywhere, "Tracks"};
  const ActionGroup track{all, KeyMode::debugger, "Tracks"};
  const auto running = [](const State& s) { return s.results.map.running; };
  map.add("map.make", "Track planes over all frames")
      .key("Ctrl+Shift+M")
      .words("track tracks follow slam")
      .when([=](const State& s) { return s.document.current() && !running(s); })
      .run(follow_planes);
  map.add("map.stop", "Stop tracking").key("Alt+K").when(running).run(stop_following);

  // Goes to another frame of the selected track.
  const auto add_way = [&](const char* name, const char* title, const char* key, Find find,
                           int direction, const char* none) {
    track.add(name, title).key(key).when(has_track).run([=](State& s) {
      const int id = s.view.tracks.track;
      const int frame = find(*s.map(), *s.map()->track(id), s.document.frame, direction);
      if (frame < 0) return say_nothing_done(s, fmt::format("T{} {}", id, none));
      show_track(s, id, frame);
    });
  };
  add_way("track.previous", "Previous frame of the track", "Alt+PageUp", frame_seen, -1,
          "is not in an earlier frame");
  add_way("track.next", "Next frame of the track", "Alt+PageDown", frame_seen, 1,
          "is not in a later frame");
  add_way("track.gap.previous", "Previous gap of the track", "Shift+PageUp", frame_missed, -1,
          "is not missed in an earlier frame");
  add_way("track.gap.next", "Next gap of the track", "Shift+PageDown", frame_missed, 1,
          "is not missed in a later frame");
  track.add("track.show", "Show a track")
      .when([](const State& s) { return s.map() != nullptr; })
      .run(Takes<TrackFrame>{"TRACK[,FRAME]", read_track}, [](State& s, const TrackFrame& at) {
        show_track(s, at.track, at.frame.value_or(s.document.frame));
      });
  track.add("track.filter", "Filter the tracks").run(text("[FILTER]"), set_track_filter);
  track.add("track.color", "Color tracks by")
      .run(choice<TrackColor>("track|area|rms"),
           [](State& s, TrackColor by) { s.view.tracks.color_by = by; });
}

}  // namespace planescope::desktop
