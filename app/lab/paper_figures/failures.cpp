// Where planes are lost: of each set the frame that profile refined does worst on.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "app/lab/paper_figures/parts.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "render/scenes.hpp"

namespace planescope::app::figures {
namespace {

constexpr int kPanelWidth = 640, kPanelHeight = 560;
constexpr int kMinTruthVoxels = 20;  // smaller true planes of depth images are not scored
constexpr int kFramesAtMost = 12;    // looked at of each set
constexpr int kFramesWhenQuick = 3;
constexpr double kNoiseM = 0.003;  // of clouds
constexpr int kCopyWidth = 1280;

int frames_looked_at(const Work& work) {
  return work.results.quick ? kFramesWhenQuick : kFramesAtMost;
}

struct Scored {
  lab::EvaluationFrame frame;
  planes::FrameResult result;
  planes::SourceTruth truth;
  planes::Metrics metrics;

  /// In the cloud's own axes, which stand upright.
  const Vec3d& truth_normal(std::int32_t plane) const {
    return frame.normals[static_cast<std::size_t>(plane) - 1];
  }
};

Scored run_and_score(const lab::EvaluationSet& set, int index, const Work& work) {
  lab::EvaluationOptions evaluation;
  evaluation.seed = work.results.seed;
  evaluation.noise_m = set.depth ? 0 : kNoiseM;
  evaluation.errors = lab::DepthErrors::d435;
  const lab::CellKey frames = set.depth
                                  ? lab::depth_of(set.name, work.results.seed, "d435")
                                  : lab::clouds_of(set.name, work.results.seed, 100 * kNoiseM);
  const planes::PipelineOptions options =
      options_of(lab::with_ours(frames, "refined", "gcn"), work);
  Scored scored;
  scored.frame = lab::make_evaluation_frame(set, index, evaluation);
  scored.truth = set.depth ? planes::truth_of_labels(*scored.frame.labels)
                           : *planes::truth_of_cloud(*scored.frame.frame.cloud);
  scored.result = planes::run_frame(scored.frame.frame, options, work.network.get());
  scored.metrics = set.depth ? planes::score_voxels(scored.result, scored.truth, kMinTruthVoxels)
                             : planes::score_frame(scored.result, scored.truth);
  return scored;
}

/// From above and from the side on which most true planes show their outer side.
render::Camera truth_camera(const Scored& scored) {
  constexpr int kSides = 8;
  constexpr double kDown = -0.7;
  Vec3d best = Vec3d::UnitX();
  double most = -1;
  for (int side = 0; side < kSides; ++side) {
    const double yaw = 2 * std::numbers::pi * (side + 0.35) / kSides;
    const Vec3d forward = Vec3d(std::cos(yaw), std::sin(yaw), kDown).normalized();
    double seen = 0;
    for (const std::int32_t plane : scored.truth.values.instance)
      if (plane > 0) seen += std::max(0.0, -scored.truth_normal(plane).dot(forward));
    if (seen <= most) continue;
    most = seen;
    best = forward;
  }
  return close_camera(scored.result.cloud.points, best,
                      static_cast<double>(kPanelWidth) / kPanelHeight);
}

/// Truth, what was found, and where they differ.
Image8 three_panels(const Scored& scored, const planes::JudgedFrame& judged, const Work& work) {
  const Frame& frame = scored.frame.frame;
  const std::vector<int> colors = colors_by_truth(judged, scored.result.segmentation.planes.size());
  if (!frame.is_cloud()) return render::image_truth(frame, scored.result, judged, colors);
  const render::Camera camera = truth_camera(scored);
  std::vector<Image8> panels;
  for (render::DrawList& list : render::scenes_truth(scored.result, judged, colors)) {
    list.points[0].size_m = 0.02F;  // sparse clouds close
    panels.push_back(
        work.renderer.render(list, camera, kPanelWidth, kPanelHeight, render::Theme::light));
  }
  return render::side_by_side(panels);
}

void add_worst(lab::PaperFigure& figure, const Work& work, const lab::EvaluationSet& set) {
  const int frames = std::min(set.frames, frames_looked_at(work));
  std::optional<Scored> worst;
  double sum = 0;
  for (int index = 0; index < frames; ++index) {
    work.begin(fmt::format("worst of {}, frame {}", set.name, index));
    Scored scored = run_and_score(set, index, work);
    sum += scored.metrics.mean_iou;
    if (!worst || scored.metrics.mean_iou < worst->metrics.mean_iou) worst = std::move(scored);
  }
  if (!worst) return;
  const planes::JudgedFrame judged = planes::judge_frame(worst->result, worst->truth);
  const planes::Metrics& m = worst->metrics;
  const std::string text = fmt::format(
      "{}: {}. Mean IoU {:.1f} %, of these {} frames {:.1f} %; {} planes found of {}; {}",
      worst->frame.name, set.meaning, m.mean_iou, frames, sum / frames, m.planes_found,
      m.planes_truth, render::errors_text(judged));
  add_picture(figure, set.name, "", text, three_panels(*worst, judged, work), kCopyWidth);
}

}  // namespace

lab::PaperFigure failures(const Work& work) {
  lab::PaperFigure figure;
  figure.id = "failures";
  figure.title = "Where planes are lost";
  figure.note = fmt::format(
      "Of each set the frame with the lowest mean IoU among its first {0}, profile refined, labels "
      "of the 3D-GCN: truth, found, and the points that are wrong. To look into one: planescope "
      "synth set NAME --seed {1} --noise {2} (clouds) or --errors d435 (depth images) -o DIR",
      frames_looked_at(work), work.results.seed, kNoiseM);
  const std::vector<std::string>& depth_sets = lab::depth_sets();
  for (const lab::EvaluationSet& set : lab::evaluation_sets())
    if (!set.depth || std::ranges::count(depth_sets, set.name) > 0) add_worst(figure, work, set);
  return figure;
}

}  // namespace planescope::app::figures
