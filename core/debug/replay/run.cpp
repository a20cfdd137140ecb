#include "core/debug/replay/run.hpp"

#include "core/debug/replay/facts.hpp"
#include "core/debug/replay/truth_check.hpp"

namespace planescope::debug {

double Run::theta_rms(const Vec3d& p) const {
  return segmentation.noise.theta_rms((p - subject->prepared.sensor()).norm());
}

double Run::tau(const Vec3d& p) const {
  return segmentation.noise.tau((p - subject->prepared.sensor()).norm());
}

std::shared_ptr<const Run> make_run(std::shared_ptr<const Subject> subject,
                                    const planes::PipelineOptions& options) {
  auto run = std::make_shared<Run>();
  const planes::PreparedFrame& prepared = subject->prepared;
  run->subject = std::move(subject);
  run->options = options;
  run->segment_options = planes::segment_options(prepared, options);
  run->segmentation =
      planes::find_regions(run->subject->frame, prepared, options, &run->trace).segmentation;
  run->timeline = run->is_ours() ? Timeline(run->trace, run->segmentation)
                                 : Timeline(run->segmentation, prepared.voxels.points);
  run->facts = facts_of(*run);
  run->wrong = wrong_decisions(*run);
  return run;
}

}  // namespace planescope::debug
