#include "core/debug/replay/subject.hpp"

#include <algorithm>

namespace planescope::debug {
namespace {

std::size_t source_count(const Frame& frame) {
  return frame.is_cloud() ? frame.cloud->points.size() : frame.depth.pixels();
}

VoxelTruth truth_by_voxel(const planes::PreparedFrame& prepared, const planes::SourceTruth& truth) {
  const planes::FrameTruth on_points = planes::truth_on_points(truth.values, prepared.cloud.source);
  VoxelTruth result;
  result.label = planes::vote_labels(prepared.voxels, on_points.label);
  result.plane = planes::vote_instances(prepared.voxels, on_points.instance);
  for (const std::int32_t plane : result.plane)
    result.plane_count = std::max(result.plane_count, plane);
  return result;
}

}  // namespace

std::uint32_t Subject::voxel_of_source(std::size_t source) const {
  if (source >= point_of_source.size()) return planes::kNoVoxel;
  const std::uint32_t point = point_of_source[source];
  return point == planes::kNoVoxel ? planes::kNoVoxel : prepared.voxels.voxel_of[point];
}

std::shared_ptr<const Subject> make_subject(Frame frame,
                                            std::optional<planes::SourceTruth> truth,
                                            const planes::PipelineOptions& options,
                                            const planes::Classifier* classifier) {
  auto subject = std::make_shared<Subject>();
  std::optional<planes::FrameTruth> on_points;
  if (truth) on_points = planes::truth_on_points(truth->values, planes::measured_sources(frame));
  subject->prepared =
      planes::prepare_frame(frame, options, classifier, on_points ? &*on_points : nullptr);

  const std::vector<std::uint32_t>& source = subject->prepared.cloud.source;
  subject->point_of_source.assign(source_count(frame), planes::kNoVoxel);
  for (std::size_t i = 0; i < source.size(); ++i)
    subject->point_of_source[source[i]] = static_cast<std::uint32_t>(i);
  if (truth) subject->voxel_truth = truth_by_voxel(subject->prepared, *truth);
  subject->frame = std::move(frame);
  subject->truth = std::move(truth);
  return subject;
}

}  // namespace planescope::debug
