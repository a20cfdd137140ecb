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
  std::optional<Vec3d> sensor;
  if (!result.from_cloud) sensor = result.cloud.T_world_sensor.translation();
  const std::vector<planes::Outline> minor = planes::minor_outlines_of(result, cell_m);
  found.stairs = planes::find_stairs({result.segmentation.planes, found.outlines},
                                     {result.segmentation.minor, minor}, sensor, options.stairs);
  return found;
}

}  // namespace planescope::report
