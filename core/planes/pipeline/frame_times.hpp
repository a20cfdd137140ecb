#pragma once

// Sums of a frame's timings [ms].

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// From voxel grid to planes, as the paper's table IV adds it up: t_d + t_c + t_b + t_s.
inline double paper_ms(const FrameTimings& t) { return t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms; }

/// With reading and back-projection.
inline double total_ms(const FrameTimings& t) {
  return t.load_ms + t.cloud_ms + t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms;
}

}  // namespace planescope::planes
