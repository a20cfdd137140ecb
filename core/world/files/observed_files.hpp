#pragma once

// What single frames tell of a map, as files: made side by side on many machines, joined by one.

#include <filesystem>
#include <string>
#include <vector>

#include "core/world/map_recording.hpp"

namespace planescope::world {

/// Of all that a frame's planes follow from but the frame: the options, the poses and gravity.
std::string observed_key(const planes::PipelineOptions& options,
                         const io::RecordingInfo& recording,
                         const UprightPoses& upright);

/// CBOR, schema "planescope.observed/4": the frame's planes to the bit, and which pixel is on
/// which.
std::vector<unsigned char> observed_bytes(const ObservedFrame& frame, const std::string& key);
/// All but what the frame itself, its pose and the options tell. Throws Error naming the file where
/// it is none, or of another key.
ObservedFrame read_observed(const std::filesystem::path& file, const std::string& key);

}  // namespace planescope::world
