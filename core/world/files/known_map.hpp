#pragma once

// What `planescope map` wrote about the frames of a recording, read again.

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "core/io/recording.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::world {

struct KnownMap : UprightPoses {
  std::filesystem::path dir;
  std::map<int, std::vector<int>> track_of_plane;  // by frame, then by plane id - 1; 0 none

  bool knows(int frame) const { return pose_of(poses, frame) && track_of_plane.contains(frame); }
};

/// Of DIR/map.json, tracks.json and poses.tum. Throws Error naming the file that is missing or
/// damaged, or is of another recording or of planes that were found with other options.
std::shared_ptr<const KnownMap> read_known_map(const std::filesystem::path& dir,
                                               const io::RecordingInfo& recording,
                                               const planes::PipelineOptions& options);

/// The recording whose frames, where the map knows them, have its gravity and noise, so that their
/// planes with options_of_map() are the map's.
std::shared_ptr<const io::Recording> with_map(std::shared_ptr<const io::Recording> recording,
                                              std::shared_ptr<const KnownMap> map);

/// The tracks of the planes of a frame that it knows, by id - 1. Throws Error where it knows
/// another number of planes.
const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes);

}  // namespace planescope::world
