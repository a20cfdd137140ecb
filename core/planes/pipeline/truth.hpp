#pragma once

// Ground truth of a frame, from label files or from a cloud's own fields, and scores against it.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// Truth per source element: depth pixel v * width + u, or point in file order. That order does not
/// depend on range, cube or gravity, so truth can be read before the cloud is made.
struct SourceTruth {
  FrameTruth values;           // label 0 unknown, 1 h, 2 v; instance 0 none, -1 not scored
  std::vector<Vec3d> normals;  // by instance - 1, sensor frame; zero vector or absent: unknown
};

SourceTruth truth_of_labels(const FrameLabels& labels);
/// nullopt if the cloud has neither labels nor instances.
std::optional<SourceTruth> truth_of_cloud(const PointSet& set);

/// Maps truth to the points of a cloud. `source`: Cloud::source.
FrameTruth truth_on_points(const FrameTruth& truth, std::span<const std::uint32_t> source);

/// Source elements that make_cloud() keeps as points of this frame, for any options.
std::vector<std::uint32_t> measured_sources(const Frame& frame);

/// Input of the classifier for a frame (its voxels), with true labels (`unknown` without truth).
/// Throws Error if gravity cannot be resolved.
LabeledCloud labeled_frame(const Frame& frame,
                           const PipelineOptions& options,
                           const SourceTruth& truth);

// ---- Scores ----

/// Smallest true planes to score. Smaller ones are ignored, along with the points found on them.
struct LeastTruePlane {
  int points = 1;  // scored points: pixels of a depth image
  int voxels = 0;  // voxels with a majority of points on the plane
};

/// Metrics of a frame's result on its own points. Points that were cropped (range, cube) or are
/// marked in the truth are not scored.
Metrics score_frame(const FrameResult& result,
                    const SourceTruth& truth,
                    const LeastTruePlane& least = {});

/// Metrics of a frame's result on its voxels. A voxel belongs to the true plane of most of its
/// points. Planes of fewer than `min_truth_voxels` are not scored.
Metrics score_voxels(const FrameResult& result, const SourceTruth& truth, int min_truth_voxels);

/// Like score_frame(), for an external segmentation given as pixel labels of the frame. Pixels
/// beyond the range or outside the cube of `options` are not scored.
Metrics score_labels(const Frame& frame,
                     const FrameLabels& found,
                     const FrameLabels& truth,
                     const CloudOptions& options);

/// Evaluation of one point against the truth.
enum class Verdict : std::uint8_t {
  unscored,
  right,
  missed,       // on a true plane, but in no found plane
  invented,     // in a found plane, but on no true plane
  wrong_plane,  // in a found plane other than the match of its true plane
  wrong_class,  // in the right plane, which has the wrong label (h or v)
};

struct EvaluatedFrame {
  std::vector<std::int32_t> true_plane;  // per cloud point, 1, 2, ...; 0 none, -1 unknown
  std::vector<Verdict> verdict;          // per cloud point
  std::vector<int> found_of;             // by true_plane - 1: the matched found plane, or 0
};
EvaluatedFrame evaluate_frame(const FrameResult& result, const SourceTruth& truth);

}  // namespace planescope::planes
