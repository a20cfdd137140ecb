#pragma once

// Ground truth of a frame, from its labels or from a cloud's own fields, and a result held to it.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/evaluate/metrics.hpp"
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

// ---- Scores ----

/// Smaller true planes are not scored: neither they nor what is found on them count.
struct LeastTruePlane {
  int points = 1;  // that are scored: pixels of a depth image
  int voxels = 0;  // that are the plane's by most of their points
};

/// The metrics of a frame's result on its own points. Points that were cropped (range, cube) are
/// not scored, nor are those whose truth says so.
Metrics score_frame(const FrameResult& result,
                    const SourceTruth& truth,
                    const LeastTruePlane& least = {});

/// The metrics of a frame's result on its voxels: a voxel belongs to the true plane that most of
/// its points do, and planes of fewer than `min_truth_voxels` are not scored.
Metrics score_voxels(const FrameResult& result, const SourceTruth& truth, int min_truth_voxels);

/// As score_frame() for a segmentation that was made elsewhere, as labels on the pixels of the
/// frame. Pixels beyond the range, or outside the cube, of `options` are not scored.
Metrics score_labels(const Frame& frame,
                     const FrameLabels& found,
                     const FrameLabels& truth,
                     const CloudOptions& options);

/// What became of a point.
enum class Verdict : std::uint8_t {
  unscored,
  right,
  missed,       // on a true plane, and in no plane
  invented,     // in a plane, and on none
  wrong_plane,  // in another plane than the one that stands for its own
  wrong_class,  // in the right plane, which is taken for h where it is v, or the reverse
};

struct JudgedFrame {
  std::vector<std::int32_t>
      true_plane;                // per cloud point, from 1 on without gaps; 0 none, -1 unknown
  std::vector<Verdict> verdict;  // per cloud point
  std::vector<int> found_of;     // by true_plane - 1: the found plane that stands for it, or 0
};
JudgedFrame judge_frame(const FrameResult& result, const SourceTruth& truth);

}  // namespace planescope::planes
