#pragma once

// Planes followed over all frames of a recording, as the window shows them. Pure functions.

#include <memory>
#include <string>
#include <vector>

#include "app/desktop/state/session.hpp"
#include "app/desktop/state/state.hpp"
#include "core/world/map_recording.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::desktop {

/// Immutable, made by a job.
struct MapView {
  std::shared_ptr<const io::Recording> recording;
  io::PickedGravity picked;
  std::string key;  // of the options that planes were found with
  world::WorldMap map;
  // By track id - 1; of those that the map does not hold, empty and 0:
  std::vector<planes::Outline> outlines;
  std::vector<double> area_m2;
  std::vector<int> colors;  // color ids, of all tracks

  const world::Tracker& tracker() const { return map.tracker; }
  /// Null: there is none, or it was merged into another one.
  const world::Track* track(int id) const;
  const world::CameraPose* pose(int frame) const;     // null: it has none
  const world::FrameOfTracks* told(int frame) const;  // null: not part of the map
  std::pair<int, int> frames() const;                 // first and last
};
/// Outlines, areas and colors of a map that was made.
void complete(MapView& view);

/// Frame and planes are those that the map was made with.
bool is_fresh(const MapView& view, const Document& document);

/// Tracks as rows of the timeline: those that the filter leaves, in order of birth.
std::vector<const world::Track*> track_rows(const State& state);
/// What the selected track is in the frame looked at; empty where there is none.
std::string track_text(const State& state);
/// The frame nearest to `from` in a direction in which the track was seen, or was missed; -1: none.
int frame_seen(const MapView& view, const world::Track& track, int from, int direction);
int frame_missed(const MapView& view, const world::Track& track, int from, int direction);

/// Color ids of a run's planes by plane id - 1: those of their tracks, 0 of planes that have none.
/// Empty where the run's planes are not the map's.
std::vector<int> colors_by_track(const MapView& view, const debug::Run& run);
/// From the scene of a run to the map's world; nothing where its frame has no pose.
std::optional<Pose> T_map_scene(const MapView& view, const debug::Run& run);
/// Outlines of the planes that were seen up to the run's frame, in its scene.
std::vector<render::DrawLines> map_lines(const MapView& view, const debug::Run& run);

/// The track's plane in the run, or the decision that lost it there.
RunArrival arrival_at_track(const MapView& view, int track, const debug::Run& run);

}  // namespace planescope::desktop
