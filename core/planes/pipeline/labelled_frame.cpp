#include "core/planes/pipeline/labelled_frame.hpp"

#include "core/model/error.hpp"

namespace planescope::planes {

LabelledCloud labelled_frame(const Frame& frame,
                             const PipelineOptions& options,
                             const SourceTruth& truth) {
  const Gravity gravity = resolve_gravity(frame, options.gravity);
  if (!gravity.known())
    throw Error("frame " + frame.name +
                ": h and v are told by gravity, which --gravity none leaves open");
  const Cloud cloud = make_cloud(frame, gravity, options.cloud);
  const VoxelCloud voxels = voxelize(cloud, options.cloud.voxel_size_m);
  const FrameTruth on_points = truth_on_points(truth.values, cloud.source);
  const std::vector<std::uint8_t> votes = vote_labels(voxels, on_points.label);
  LabelledCloud labelled;
  labelled.kind = "recording";
  labelled.points = voxels.points;
  for (const std::uint8_t vote : votes) labelled.labels.push_back(static_cast<Label>(vote));
  return labelled;
}

}  // namespace planescope::planes
