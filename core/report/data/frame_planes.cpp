#include "core/report/data/frame_planes.hpp"

namespace planescope::report {

FramePlanes frame_planes(const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::PipelineOptions& options) {
  const double cell_m = cell_size_m(options.cloud.voxel_size_m);
  FramePlanes found;
  found.summaries = summarize_planes(result, options.cloud.voxel_size_m);
  found.outlines = planes::outlines_of(frame, result, cell_m);
  found.footholds = planes::footholds_of(frame, result, found.outlines, cell_m, options.foot);
  return found;
}

}  // namespace planescope::report
