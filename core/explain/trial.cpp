#include "core/explain/trial.hpp"

namespace planescope {

std::vector<std::int32_t> planes_with(const Subject& subject, const PipelineOptions& options) {
  return find_regions(subject.frame, subject.prepared, options).segmentation.plane_of;
}

}  // namespace planescope
