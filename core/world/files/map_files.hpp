#pragma once

// map.json and tracks.json. All in the map's world: z up, metres.

#include <string>

#include "core/world/map_recording.hpp"

namespace planescope::world {

/// The tracks that the map holds, by area, the largest first; those that are gone after the others.
std::vector<const Track*> planes_of_map(const Tracker& tracker);

/// What is written of a map.
struct MapTexts {
  std::string poses_tum;
  std::string tracks_json;  // schema "planescope.tracks/4": which plane of which frame is which
                            // track, and why a track is missing where it is
  std::string map_json;     // schema "planescope.map/4", with SHA-256 of the two others
};
/// `recording`: its name, as the files tell it.
MapTexts map_texts(const WorldMap& map, const std::string& recording);

/// A line of left.jsonl: a piece of a plane that left the window, as map.json has planes.
std::string left_json(const LeftPiece& piece);
/// schema "planescope.pace/1".
std::string pace_json(const Pace& pace);

/// For people, a few lines.
std::string stability_text(const Stability& stability);

}  // namespace planescope::world
