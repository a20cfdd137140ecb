#include "core/explain/trial.hpp"

namespace planescope {

std::vector<std::int32_t> planes_with(const Subject& subject, const PipelineOptions& options) {
  const PreparedFrame& prepared = subject.prepared;
  return segment(prepared.voxels.points, prepared.classification.labels, prepared.cloud.cube,
                 prepared.sensor(), segment_options(prepared, options))
      .plane_of;
}

}  // namespace planescope
