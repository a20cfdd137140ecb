#pragma once

// What is looked at: one frame, made ready for segmentation once, however often it is then run.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::debug {

/// Ground truth by voxel, by majority of its points. Empty vectors where the frame has none.
struct VoxelTruth {
  std::vector<std::uint8_t> label;  // 0 unknown, 1 h, 2 v
  std::vector<std::int32_t> plane;  // truth plane id from 1, 0 none, -1 not scored
  int plane_count = 0;              // greatest id

  bool known() const { return !plane.empty(); }
};

struct Subject {
  Frame frame;
  planes::PreparedFrame prepared;
  std::optional<planes::SourceTruth> truth;
  VoxelTruth voxel_truth;
  std::vector<std::uint32_t> point_of_source;  // pixel v * width + u, or index in the file -> cloud
                                               // point; kNoVoxel where nothing was measured

  std::size_t voxel_count() const { return prepared.voxels.points.size(); }
  /// kNoVoxel where nothing was measured, or it was cropped.
  std::uint32_t voxel_of_source(std::size_t source) const;
};

/// Throws as prepare_frame() does.
std::shared_ptr<const Subject> make_subject(Frame frame,
                                            std::optional<planes::SourceTruth> truth,
                                            const planes::PipelineOptions& options,
                                            const planes::Classifier* classifier);

}  // namespace planescope::debug
