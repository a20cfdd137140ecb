#include "core/planes/pipeline/truth.hpp"

#include <algorithm>

#include "core/model/error.hpp"

namespace planescope::planes {

SourceTruth truth_of_labels(const FrameLabels& labels) {
  SourceTruth truth;
  const std::size_t pixels = labels.plane.pixels();
  truth.values.label.resize(pixels);
  truth.values.instance.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t hv = labels.hv.empty() ? std::uint8_t{0} : labels.hv.data[i];
    truth.values.label[i] = hv <= 2 ? hv : std::uint8_t{0};
    const std::uint16_t id = labels.plane.data[i];
    truth.values.instance[i] = id == kPlaneIgnore ? -1 : id;
  }
  for (const LabelPlane& plane : labels.planes) {
    if (plane.id < 1) continue;
    if (truth.normals.size() < static_cast<std::size_t>(plane.id))
      truth.normals.resize(static_cast<std::size_t>(plane.id), Vec3d::Zero());
    truth.normals[static_cast<std::size_t>(plane.id) - 1] = plane.normal;
  }
  return truth;
}

std::optional<SourceTruth> truth_of_cloud(const PointSet& set) {
  if (set.label.empty() && set.instance.empty()) return std::nullopt;
  const std::size_t n = set.points.size();
  SourceTruth truth;
  truth.values.label = set.label;
  truth.values.label.resize(n, 0);
  for (std::uint8_t& label : truth.values.label)
    if (label > 2) label = 0;
  truth.values.instance = set.instance;
  truth.values.instance.resize(n, -1);  // h and v alone say nothing about planes
  return truth;
}

FrameTruth truth_on_points(const FrameTruth& truth, std::span<const std::uint32_t> source) {
  FrameTruth gathered;
  gathered.label.resize(source.size());
  gathered.instance.resize(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    gathered.label[i] = truth.label[source[i]];
    gathered.instance[i] = truth.instance[source[i]];
  }
  return gathered;
}

std::vector<std::uint32_t> measured_sources(const Frame& frame) {
  return make_cloud(frame, Gravity{}, CloudOptions{}).source;
}

LabelledCloud labelled_frame(const Frame& frame,
                             const PipelineOptions& options,
                             const SourceTruth& truth) {
  const Gravity gravity = resolve_gravity(frame, options.gravity, options.cloud.max_range_m);
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
