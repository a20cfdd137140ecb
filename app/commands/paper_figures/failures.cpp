// Where planes are lost: of each set the frame that profile refined does worst on.

#include <fmt/format.h>

#include <optional>

#include "app/commands/paper_figures/parts.hpp"
#include "core/synthetic/evaluation_sets.hpp"
#include "render/scenes.hpp"
#include "render/truth_image.hpp"

namespace planescope::figures {
namespace {

constexpr int kPanelWidth = 640, kPanelHeight = 560;
constexpr int kMinTruthVoxels = 20;  // smaller true planes of depth images are not scored
constexpr int kFramesAtMost = 12;    // looked at of each set
constexpr int kFramesWhenQuick = 3;
constexpr double kNoiseM = 0.003;  // of clouds
constexpr int kCopyWidth = 1280;

struct Scored {
  EvaluationFrame frame;
  FrameResult result;
  SourceTruth truth;
  Metrics metrics;
};

Scored run_and_score(const EvaluationSet& set, int index, const Work& work) {
  EvaluationOptions evaluation;
  evaluation.seed = work.results.seed;
  evaluation.noise_m = set.depth ? 0 : kNoiseM;
  evaluation.errors = DepthErrors::d435;
  const CellKey frames = set.depth ? depth_of(set.name, work.results.seed, "d435")
                                   : clouds_of(set.name, work.results.seed, 100 * kNoiseM);
  const PipelineOptions options = options_of(with_ours(frames, "refined", "gcn"), work);
  Scored scored;
  scored.frame = make_evaluation_frame(set, index, evaluation);
  scored.truth = set.depth ? truth_of_labels(*scored.frame.labels)
                           : *truth_of_cloud(*scored.frame.frame.cloud);
  scored.result = run_frame(scored.frame.frame, options, work.network.get());
  scored.metrics = set.depth ? score_voxels(scored.result, scored.truth, kMinTruthVoxels)
                             : score_frame(scored.result, scored.truth);
  return scored;
}

/// Truth, what was found, and where they differ.
Image8 three_panels(const Scored& scored, const JudgedFrame& judged, const Work& work) {
  const Frame& frame = scored.frame.frame;
  const std::vector<int> colors = colors_by_truth(judged, scored.result.segmentation.planes.size());
  if (!frame.is_cloud()) return image_truth(frame, scored.result, judged, colors);
  const Camera camera =
      frame_camera(scored.result, static_cast<double>(kPanelWidth) / kPanelHeight);
  std::vector<Image8> panels;
  for (const DrawList& list : scenes_truth(scored.result, judged, colors))
    panels.push_back(work.renderer.render(list, camera, kPanelWidth, kPanelHeight, Theme::light));
  return side_by_side(panels);
}

void add_worst(PaperFigure& figure, const Work& work, const EvaluationSet& set) {
  const int frames = std::min(set.frames, work.results.quick ? kFramesWhenQuick : kFramesAtMost);
  std::optional<Scored> worst;
  double sum = 0;
  for (int index = 0; index < frames; ++index) {
    work.begin(fmt::format("worst of {}, frame {}", set.name, index));
    Scored scored = run_and_score(set, index, work);
    sum += scored.metrics.mean_iou;
    if (!worst || scored.metrics.mean_iou < worst->metrics.mean_iou) worst = std::move(scored);
  }
  if (!worst) return;
  const JudgedFrame judged = judge_frame(worst->result, worst->truth);
  const Metrics& m = worst->metrics;
  add_picture(
      figure, set.name, "",
      fmt::format("{}: mean IoU {:.1f} %, of these {} frames {:.1f} %; {} planes found of {}; "
                  "{}",
                  worst->frame.name, m.mean_iou, frames, sum / frames, m.planes_found,
                  m.planes_truth, errors_text(judged)),
      three_panels(*worst, judged, work), kCopyWidth);
}

}  // namespace

PaperFigure failures(const Work& work) {
  PaperFigure figure;
  figure.id = "failures";
  figure.title = "Where planes are lost";
  figure.note = fmt::format(
      "Of each set the frame with the lowest mean IoU, profile refined, labels of the 3D-GCN: "
      "truth, "
      "found, and the points that are wrong. Clouds with 0.3 cm of noise, depth images through the "
      "whole camera model, seed {0}. To look into one: planescope synth set NAME --seed {0} -o DIR",
      work.results.seed);
  for (const EvaluationSet& set : evaluation_sets()) add_worst(figure, work, set);
  return figure;
}

}  // namespace planescope::figures
