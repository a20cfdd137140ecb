#pragma once

// Writes and reads map.json, tracks.json and poses.tum, and the observations of single frames,
// which separate machines can compute in parallel before they are joined into one map. Everything
// is in the map's world frame: z up, meters.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::world {

/// Tracks contained in the map, largest area first; tracks that are gone come last.
std::vector<const Track*> planes_of_map(const Tracker& tracker);

/// Contents of a map's files.
struct MapTexts {
  std::string poses_tum;
  std::string tracks_json;  // schema "planescope.tracks/4": the track of each plane in each frame,
                            // and the reason for each missing track
  std::string map_json;     // schema "planescope.map/4", with the SHA-256 of the other two
};
/// `recording`: its name in the files.
MapTexts map_texts(const WorldMap& map, const std::string& recording);

/// A line of left.jsonl: a piece of a plane that left the window, in the format of
/// map.json's planes.
std::string left_json(const LeftPiece& piece);
/// Schema "planescope.pace/1".
std::string pace_json(const Pace& pace);

/// A summary of a few lines for users.
std::string stability_text(const Stability& stability);

// ---- Reading ----

struct KnownMap : UprightPoses {
  std::filesystem::path dir;
  struct FramePlanes {
    std::vector<int> tracks;       // by plane id - 1; 0 none
    std::string sha256;            // of the image of the frame's planes; empty: not stored
    std::vector<double> margins;   // by id - 1, minor planes last
    std::optional<Vec3d> gravity;  // unit, camera frame, as used to find the planes
  };
  std::map<int, FramePlanes> planes_of;  // by frame

  bool knows(int frame) const { return pose_of(poses, frame) && planes_of.contains(frame); }
};

/// Reads DIR/map.json, tracks.json and poses.tum. Throws Error naming the file if it is missing or
/// damaged, or belongs to another recording or to planes found with different options.
std::shared_ptr<const KnownMap> read_known_map(const std::filesystem::path& dir,
                                               const io::RecordingInfo& recording,
                                               const planes::PipelineOptions& options);

/// Path of the image of a frame's planes: 16 bit, the plane id per pixel.
std::filesystem::path planes_file(const std::filesystem::path& dir, int frame);

/// A recording whose frames, if in the map, have the map's gravity and planes. Methods that do not
/// find planes on pixels find the same planes again with options_of_map().
std::shared_ptr<const io::Recording> with_map(std::shared_ptr<const io::Recording> recording,
                                              std::shared_ptr<const KnownMap> map);

/// Tracks of the planes of a frame in the map, by id - 1. Throws Error if the number of
/// planes differs.
const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes);

// ---- Single frames ----

/// planes_from(), plus an identification of poses and gravity under "poses".
PlanesFrom planes_from(const planes::PipelineOptions& options,
                       const io::RecordingInfo& recording,
                       const UprightPoses& upright);

/// CBOR, schema "planescope.observed/5": the exact planes of the frame and the plane of each pixel,
/// followed by the SHA-256 of the CBOR data as 64 hexadecimal digits.
std::vector<unsigned char> observed_bytes(const ObservedFrame& frame, const PlanesFrom& from);
/// Reads everything except the data defined by the frame itself, its pose and the options. Throws
/// Error naming the file if it is damaged or was made with a different camera, options or poses.
ObservedFrame read_observed(const std::filesystem::path& file, const PlanesFrom& expected);

}  // namespace planescope::world
