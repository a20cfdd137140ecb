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
  std::map<int, const CameraPose*> pose_of;        // by frame, into `poses`
  std::map<int, std::vector<int>> track_of_plane;  // by frame, then by plane id - 1; 0 none
};

/// Of DIR/map.json, tracks.json and poses.tum. Throws Error naming the file that is missing or
/// damaged, or whose planes were found with other options.
std::shared_ptr<const KnownMap> read_known_map(const std::filesystem::path& dir,
                                               const planes::PipelineOptions& options);

/// The recording whose frames know the map's gravity and noise, so that their planes are the map's.
/// Frames that the map has no pose of throw Error.
std::shared_ptr<const io::Recording> with_map(std::shared_ptr<const io::Recording> recording,
                                              std::shared_ptr<const KnownMap> map);

/// The tracks of a frame's planes, by id - 1. Throws Error where the map knows another number of
/// planes.
const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes);

}  // namespace planescope::world
