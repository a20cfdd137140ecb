#pragma once

// planes.json and timings.json of a frame. Nothing but timings.json depends on time or on the
// number of threads.

#include <string>

#include "core/planes/result/analyze.hpp"

namespace planescope::planes {

/// schema "planescope.planes/4".
std::string planes_json(const Frame& frame,
                        const FrameResult& result,
                        const FramePlanes& found,
                        const PipelineOptions& options);
/// Milliseconds by stage and their sum.
std::string timings_json(const FrameTimings& timings);

}  // namespace planescope::planes
