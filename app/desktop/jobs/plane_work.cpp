#include "app/desktop/jobs/plane_work.hpp"

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

planes::FrameResult result_of(const debug::Run& run) {
  planes::FrameResult result;
  static_cast<planes::PreparedFrame&>(result) = run.subject->prepared;
  result.segmentation = run.segmentation;
  result.plane_of = run.plane_of;
  return result;
}

}  // namespace

std::shared_ptr<const render::PlaneScene> outlines_of_run(const debug::Run& run) {
  const planes::FrameResult result = result_of(run);
  auto scene = std::make_shared<render::PlaneScene>();
  scene->origin = result.cloud.origin;
  try {
    const double cell_m = planes::cell_size_m(result.voxels.size_m);
    scene->shapes = render::plane_shapes(planes::outlines_of(run.subject->frame, result, cell_m),
                                         result.cloud.origin);
  } catch (const Error&) {
    return nullptr;  // planes_of_run() says why
  }
  return scene;
}

std::shared_ptr<const RunPlanes> planes_of_run(const std::shared_ptr<const RunView>& view,
                                               const planes::PipelineOptions& options) {
  const debug::Run& run = *view->run;
  const planes::FrameResult result = result_of(run);
  planes::PipelineOptions asked = run.options;
  asked.foot = options.foot;
  asked.stairs = options.stairs;
  auto made = std::make_shared<RunPlanes>();
  made->of = view;
  made->key = planes_key(options);
  made->found = planes::analyze_planes(run.subject->frame, result, asked);
  made->scene = std::make_shared<const render::PlaneScene>(
      render::plane_scene(result.segmentation.planes, made->found.outlines, made->found.footholds,
                          made->found.stairs, result.cloud.origin));
  return made;
}

bool is_about_planes(const planes::OptionInfo& info) {
  return info.section == "foot" || info.section == "stairs";
}

std::string planes_key(const planes::PipelineOptions& options) {
  std::string key;
  for (const planes::OptionInfo& info : planes::option_table())
    if (is_about_planes(info)) key += info.get(options) + '|';
  return key;
}

}  // namespace planescope::desktop
