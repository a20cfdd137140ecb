#pragma once

// What single frames tell of a map, as files: made side by side on many machines, joined by one.

#include <filesystem>
#include <string>
#include <vector>

#include "core/world/map_recording.hpp"

namespace planescope::world {

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
