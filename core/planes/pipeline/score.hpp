#pragma once

#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::planes {

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
