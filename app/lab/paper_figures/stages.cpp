// The paper's figure of the framework: what one depth frame is at each stage.

#include <fmt/format.h>

#include "app/lab/paper_figures/parts.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "render/plane_colors.hpp"
#include "render/scenes.hpp"

namespace planescope::app::figures {
namespace {

constexpr int kStageWidth = 720, kStageHeight = 540;

}  // namespace

lab::PaperFigure stages(const Work& work) {
  work.begin("stages");
  const Frame frame = lab::make_sample_frame({.seed = work.results.seed}, 0).frame;
  const planes::PipelineOptions options = options_of(lab::with_ours({}, "paper", "gcn"), work);
  const planes::FrameResult result = planes::run_frame(frame, options, work.network.get());

  lab::PaperFigure figure;
  figure.id = "stages";
  figure.title = "The framework, stage by stage";
  figure.note = fmt::format(
      "Stairs through the camera model, profile paper, labels of the 3D-GCN. To look into it: "
      "planescope synth sample --seed {} -o sample; planescope sample --profile paper",
      work.results.seed);
  const render::Camera camera =
      render::frame_camera(result, static_cast<double>(kStageWidth) / kStageHeight);
  const auto draw = [&](render::DrawList list, const std::string& column,
                        const std::string& caption) {
    work.begin("stages, " + column);
    list = bare(std::move(list));
    add_picture(
        figure, "", column, caption,
        work.renderer.render(list, camera, kStageWidth, kStageHeight, render::Theme::light));
  };
  const planes::SegmentCounts& counts = result.segmentation.counts;
  add_picture(figure, "", "depth", "as the camera measures it",
              render::image_depth(frame, options.cloud.max_range_m));
  draw(render::scene_heights(result), "points",
       fmt::format("N_m = {} within {} m", result.cloud.counts.kept, options.cloud.max_range_m));
  draw(render::scene_labels(result), "labels",
       fmt::format("N_d = {} voxels of {} cm, h and v", result.voxels.points.size(),
                   100 * options.cloud.voxel_size_m));
  draw(render::scene_cases(result), "octree",
       fmt::format("{} nodes visited, {} candidates", counts.nodes_visited, counts.candidates));
  draw(render::scene_planes(frame, result, render::first_colors(result)), "planes",
       planes_text(result));
  return figure;
}

}  // namespace planescope::app::figures
