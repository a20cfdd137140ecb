#pragma once

// The segmentation of a run's frame with other options. Internal to core/explain.

#include <vector>

#include "core/replay/run.hpp"

namespace planescope {

/// Plane of each voxel, 0 none. Of `options`, the segment options alone count.
std::vector<std::int32_t> planes_with(const Subject& subject, const PipelineOptions& options);

}  // namespace planescope
