#pragma once

// Planes tracked over all frames of a recording, for the window. Pure functions.

#include <memory>
#include <string>
#include <vector>

#include "app/desktop/state/session.hpp"
#include "app/desktop/state/state.hpp"
#include "core/world/map_recording.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::desktop {

/// Immutable; created by a job.
struct MapView {
  std::shared_ptr<const io::Recording> recording;
  io::PickedGravity picked;
  std::string key;  // of the options used to find planes
  world::WorldMap map;
  // By track id - 1; empty and 0 for tracks that are not in the map:
  std::vector<planes::Outline> outlines;
  std::vector<double> area_m2;
  std::vector<int> colors;  // color ids of all tracks

  const world::Tracker& tracker() const { return map.tracker; }
  /// Null if it does not exist or was merged into another track.
  const world::Track* track(int id) const;
  const world::CameraPose* pose(int frame) const;          // null: no pose
  const world::FrameOfTracks* tracks_at(int frame) const;  // null: not part of the map
  std::pair<int, int> frames() const;                      // first and last
};
/// Computes outlines, areas and colors of a new map.
void complete(MapView& view);

/// Whether the map was made with the document's recording and options.
bool is_fresh(const MapView& view, const Document& document);

/// Rows of the timeline: tracks that match the filter, oldest first.
std::vector<const world::Track*> track_rows(const State& state);
/// Describes the selected track in the current frame; empty without one.
std::string track_text(const State& state);
/// The nearest frame from `from` in a direction in which the track was seen, or was missed; -1:
/// none.
int frame_seen(const MapView& view, const world::Track& track, int from, int direction);
int frame_missed(const MapView& view, const world::Track& track, int from, int direction);

/// Color ids of a run's planes by plane id - 1: those of their tracks, 0 for planes without one.
/// Empty if the run's planes are not the map's.
std::vector<int> colors_by_track(const MapView& view, const debug::Run& run);
/// Transform from the scene of a run to the map's world; nullopt if its frame has no pose.
std::optional<Pose> T_map_scene(const MapView& view, const debug::Run& run);
/// Outlines of the planes seen up to the run's frame, in its scene.
std::vector<render::DrawLines> map_lines(const MapView& view, const debug::Run& run);

/// The track's plane in the run, or the decision that lost it.
RunArrival arrival_at_track(const MapView& view, int track, const debug::Run& run);

}  // namespace planescope::desktop
