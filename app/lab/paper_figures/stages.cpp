// The paper's figure of the framework: what one depth frame is at each stage.

#include <fmt/format.h>

#include "app/lab/paper_figures/parts.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "render/scenes.hpp"

namespace planescope::figures {
namespace {

constexpr int kStageWidth = 720, kStageHeight = 540;

}  // namespace

PaperFigure stages(const Work& work) {
  work.begin("stages");
  const Frame frame = make_sample_frame({.seed = work.results.seed}, 0).frame;
  const PipelineOptions options = options_of(with_ours({}, "refined", "gcn"), work);
  const FrameResult result = run_frame(frame, options, work.network.get());

  PaperFigure figure;
  figure.id = "stages";
  figure.title = "The framework, stage by stage";
  figure.note = fmt::format(
      "Stairs through the camera model, profile refined, labels of the 3D-GCN. To look into it: "
      "planescope synth sample --seed {} -o sample; planescope sample",
      work.results.seed);
  const Camera camera = frame_camera(result, static_cast<double>(kStageWidth) / kStageHeight);
  const auto draw = [&](DrawList list, const std::string& column, const std::string& caption) {
    work.begin("stages, " + column);
    list = bare(std::move(list));
    add_picture(figure, "", column, caption,
                work.renderer.render(list, camera, kStageWidth, kStageHeight, Theme::light));
  };
  const SegmentCounts& counts = result.segmentation.counts;
  add_picture(figure, "", "depth", "as the camera measures it",
              image_depth(frame, options.cloud.max_range_m));
  draw(scene_heights(result), "points",
       fmt::format("N_m = {} within {} m", result.cloud.counts.kept, options.cloud.max_range_m));
  draw(scene_labels(result), "labels",
       fmt::format("N_d = {} voxels of {} cm, h and v", result.voxels.points.size(),
                   100 * options.cloud.voxel_size_m));
  draw(scene_cases(result), "octree",
       fmt::format("{} nodes visited, {} candidates", counts.nodes_visited, counts.candidates));
  draw(scene_planes(result, {}), "planes", planes_text(result));
  return figure;
}

}  // namespace planescope::figures
