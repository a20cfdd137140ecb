#pragma once

// The methods that are not ours, run on a prepared frame.

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// As find_regions(), for every method but ours. Those for depth images look at the pixels, and a
/// voxel gets the plane of most of its points; the others look at the voxels, and leave
/// FoundRegions::plane_of empty: a point's plane is its voxel's. Throws Error where the method does
/// not take such a frame.
FoundRegions find_rival_regions(const Frame& frame,
                                const PreparedFrame& prepared,
                                const PipelineOptions& options);

/// The label of each voxel's plane, unknown where it has none: what stands in for a classification.
std::vector<Label> labels_of_planes(const Segmentation& segmentation);

}  // namespace planescope::planes
