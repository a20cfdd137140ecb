#pragma once

// map.json, tracks.json and poses.tum, written and read again; and what single frames tell of a
// map, made side by side on many machines, joined by one. All in the map's world: z up, meters.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
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

// ---- Read again ----

struct KnownMap : UprightPoses {
  std::filesystem::path dir;
  struct FramePlanes {
    std::vector<int> tracks;       // by plane id - 1; 0 none
    std::string sha256;            // of the image of the frame's planes; empty: none is stored
    std::vector<double> margins;   // by id - 1, the minor ones' last
    std::optional<Vec3d> gravity;  // unit, in the camera, that the planes were found with
  };
  std::map<int, FramePlanes> planes_of;  // by frame

  bool knows(int frame) const { return pose_of(poses, frame) && planes_of.contains(frame); }
};

/// Of DIR/map.json, tracks.json and poses.tum. Throws Error naming the file that is missing or
/// damaged, or is of another recording or of planes that were found with other options.
std::shared_ptr<const KnownMap> read_known_map(const std::filesystem::path& dir,
                                               const io::RecordingInfo& recording,
                                               const planes::PipelineOptions& options);

/// Where the image of a frame's planes is: 16 bit, per pixel the plane's id.
std::filesystem::path planes_file(const std::filesystem::path& dir, int frame);

/// The recording whose frames, where the map knows them, have its gravity and planes; methods that
/// do not find planes on pixels find the same ones again with options_of_map().
std::shared_ptr<const io::Recording> with_map(std::shared_ptr<const io::Recording> recording,
                                              std::shared_ptr<const KnownMap> map);

/// The tracks of the planes of a frame that it knows, by id - 1. Throws Error where it knows
/// another number of planes.
const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes);

// ---- Single frames ----

/// planes_from(), and under "poses" what identifies the poses and gravity.
PlanesFrom planes_from(const planes::PipelineOptions& options,
                       const io::RecordingInfo& recording,
                       const UprightPoses& upright);

/// CBOR, schema "planescope.observed/5": the frame's planes to the bit, and which pixel is on
/// which. After it the SHA-256 of it, 64 hexadecimal digits.
std::vector<unsigned char> observed_bytes(const ObservedFrame& frame, const PlanesFrom& from);
/// All but what the frame itself, its pose and the options tell. Throws Error naming the file where
/// it is damaged or made with another camera, other options or other poses.
ObservedFrame read_observed(const std::filesystem::path& file, const PlanesFrom& expected);

}  // namespace planescope::world
