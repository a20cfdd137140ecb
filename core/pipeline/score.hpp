#pragma once

#include "core/evaluate/metrics.hpp"
#include "core/pipeline/pipeline.hpp"
#include "core/pipeline/truth.hpp"

namespace planescope {

/// The metrics of a frame's result on its own points. Points that were cropped (range, cube) are
/// not scored, nor are those whose truth says so.
Metrics score_frame(const FrameResult& result, const SourceTruth& truth);

}  // namespace planescope
