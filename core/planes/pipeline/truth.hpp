#pragma once

// Ground truth of a frame, from its labels or from a cloud's own fields.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// Truth per source element: depth pixel v * width + u, or point in the file's order. That order
/// does not depend on range, cube or gravity, so the truth can be read before the cloud is made.
struct SourceTruth {
  FrameTruth values;           // label 0 unknown, 1 h, 2 v; instance 0 none, -1 not scored
  std::vector<Vec3d> normals;  // by instance - 1, sensor frame; zero vector or absent: unknown
};

SourceTruth truth_of_labels(const FrameLabels& labels);
/// nullopt where the cloud has neither label nor instance.
std::optional<SourceTruth> truth_of_cloud(const PointSet& set);

/// Gathers truth onto the points of a cloud: `source` is Cloud::source.
FrameTruth truth_on_points(const FrameTruth& truth, std::span<const std::uint32_t> source);

/// The source elements that make_cloud() keeps as points of this frame, whatever the options.
std::vector<std::uint32_t> measured_sources(const Frame& frame);

/// What the classifier sees of a frame (its voxels) and what it should answer (`unknown` where
/// there is no truth). Throws Error where gravity cannot be found.
LabelledCloud labelled_frame(const Frame& frame,
                             const PipelineOptions& options,
                             const SourceTruth& truth);

}  // namespace planescope::planes
