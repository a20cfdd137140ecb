#include "app/desktop/tracks/map_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/commands/map_picture.hpp"
#include "app/desktop/jobs/frame_work.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/world/tracks/sight.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

using world::Moment;

/// The voxels of a run at which it measures the track, ascending.
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
  world::sight_of(track, frame, view.tracker().options(), &pixels);
  for (const std::uint32_t pixel : pixels)
    if (const std::uint32_t voxel = subject.voxel_of_source(pixel); voxel != planes::kNoVoxel)
      voxels.push_back(voxel);
  std::ranges::sort(voxels);
  const auto repeated = std::ranges::unique(voxels);
  voxels.erase(repeated.begin(), repeated.end());
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

const world::FrameOfTracks* MapView::told(int frame) const {
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
  const world::FrameOfTracks* told = view.told(run.subject->frame.index);
  if (!told || told->listed != std::ssize(run.segmentation.planes)) return {};
  std::vector<int> colors;
  for (std::size_t k = 0; k < run.segmentation.planes.size(); ++k) {
    const int track = told->track_of[k];
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

}  // namespace planescope::desktop
