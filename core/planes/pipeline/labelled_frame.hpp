#pragma once

#include "core/planes/classify/labelled_cloud.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::planes {

/// What the classifier sees of a frame (its voxels) and what it should answer (`unknown` where
/// there is no truth). Throws Error where gravity cannot be found.
LabelledCloud labelled_frame(const Frame& frame,
                             const PipelineOptions& options,
                             const SourceTruth& truth);

}  // namespace planescope::planes
