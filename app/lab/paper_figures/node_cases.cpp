// The paper's figure of cases I to IV, panels a to d: one node of each, from a real run.

#include <fmt/format.h>

#include <optional>

#include "app/lab/paper_figures/parts.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/planes/segment/criteria.hpp"
#include "render/palette.hpp"
#include "render/scenes.hpp"

namespace planescope::app::figures {
namespace {

constexpr int kWidth = 640, kHeight = 560;
constexpr double kMostEdgeM = 0.41;  // larger nodes are no close-up
constexpr double kContext = 0.35;    // of the edge: how far around the node points are shown
constexpr render::Rgba kNormal{0, 140, 70, 255};

/// What the criteria say of a node.
struct Judged {
  planes::Purity purity;
  planes::Candidate candidate;  // its inliers
  double e_n = 0;
};
Judged judge(const planes::Octree& octree,
             std::int32_t node,
             const planes::SegmentOptions& options) {
  Judged judged;
  judged.purity = planes::purity_of(octree.nodes[node], options.use_labels, options.one_label);
  judged.candidate = planes::fit_label(octree, node, judged.purity.inlier, options.use_labels);
  judged.e_n = planes::normal_error(judged.candidate.fit, options.mse_normalization);
  return judged;
}

/// How well a node shows its case: the clearest and largest are preferred.
double clarity(planes::Case c,
               const planes::OctreeNode& node,
               double edge_m,
               const Judged& judged) {
  switch (c) {
    case planes::Case::I:
      return std::min(node.count_h, node.size() - node.count_h);
    case planes::Case::II:
      return node.size() - edge_m;
    case planes::Case::III:  // e_n grows with the number of points, too
      return judged.candidate.fit.rms_m();
    case planes::Case::IV:
      return judged.purity.n_out > 0 ? node.size() : 0.1 * node.size();
    case planes::Case::none:
      break;
  }
  return 0;
}

/// The clearest node of a case, of equally clear ones the first.
std::optional<std::int32_t> pick(const planes::Octree& octree,
                                 planes::Case c,
                                 const planes::SegmentOptions& options) {
  std::optional<std::int32_t> best;
  double most = -1;
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    const planes::OctreeNode& node = octree.nodes[i];
    const double edge_m = octree.node_edge_m(node);
    if (node.decided != c || edge_m > kMostEdgeM) continue;
    const auto index = static_cast<std::int32_t>(i);
    const double clear = clarity(c, node, edge_m, judge(octree, index, options));
    if (clear <= most) continue;
    most = clear;
    best = index;
  }
  return best;
}

std::string caption(planes::Case c, const Judged& judged, const planes::SegmentOptions& options) {
  const planes::Purity& purity = judged.purity;
  switch (c) {
    case planes::Case::I:
      return fmt::format(
          "Criterion 1 fails: N_out = {} of at most {}, r_out = {:.0f} % of at most {:.0f} %. "
          "Divided.",
          purity.n_out, options.theta_n_out, 100 * purity.r_out(), 100 * options.theta_r_out);
    case planes::Case::II:
      return fmt::format("Criterion 2 fails: N_in = {} of at least {}. Left over.", purity.n_in,
                         options.theta_n_in);
    case planes::Case::III:
      return fmt::format(
          "N_out = {}, N_in = {}, but Criterion 3 fails: e_n = {:.4f} m² of at most {:.4f} m². "
          "Divided.",
          purity.n_out, purity.n_in, judged.e_n, options.theta_e_n_m2);
    case planes::Case::IV:
      return fmt::format(
          "All criteria hold: N_out = {}, N_in = {}, e_n = {:.4f} m² of at most {:.4f} m². A plane "
          "candidate, its outliers left over.",
          purity.n_out, purity.n_in, judged.e_n, options.theta_e_n_m2);
    case planes::Case::none:
      break;
  }
  return "";
}

/// The node's points in the colours of their labels inside its cell, what lies around it grey; of a
/// candidate its centroid and normal.
render::DrawList close_up(const planes::FrameResult& result,
                          std::int32_t index,
                          const Judged& judged) {
  const planes::Octree& octree = result.segmentation.octree;
  const planes::OctreeNode& node = octree.nodes[index];
  render::DrawBox cell = render::cell_box(octree, node);
  cell.color = render::kSceneText;
  const auto edge = static_cast<float>(octree.node_edge_m(node));
  const float around = static_cast<float>(kContext) * edge;

  render::DrawPoints inside, outside;
  inside.size_m = 0.4F * static_cast<float>(result.voxels.size_m);
  outside.size_m = 0.25F * static_cast<float>(result.voxels.size_m);
  inside.max_px = outside.max_px = 24;
  for (std::uint32_t i = 0; i < octree.points.size(); ++i) {
    const Vec3f& p = octree.points[i];
    const bool near = ((p - cell.corners.front()).array() >= -around).all() &&
                      ((cell.corners.back() - p).array() >= -around).all();
    const bool own = i >= node.begin && i < node.end;
    if (!near) continue;
    render::DrawPoints& points = own ? inside : outside;
    points.positions.push_back(p);
    points.colors.push_back(own ? render::label_color(octree.labels[i]) : render::kSceneFaded);
  }
  render::DrawList list;
  list.points = {std::move(outside), std::move(inside)};
  list.boxes = {cell};
  if (node.decided == planes::Case::IV) {
    const PlaneFit& fit = judged.candidate.fit;
    const Vec3d toward = result.sensor() - fit.centroid;
    const Vec3d normal = fit.normal.dot(toward) < 0 ? Vec3d(-fit.normal) : fit.normal;
    list.arrows.push_back({fit.centroid.cast<float>(),
                           (fit.centroid + 0.4 * edge * normal).cast<float>(), kNormal, 5});
  }
  list.show_axes = false;
  return list;
}

/// From where the sensor is, but more from the side: the cell is seen as a cube.
render::Camera camera_of(const planes::FrameResult& result, const render::DrawBox& cell) {
  const Vec3d middle = render::middle_of(cell).cast<double>();
  Vec3d forward = middle - result.sensor();
  forward.z() = -0.6 * forward.head<2>().norm();
  const Vec3d right = forward.cross(Vec3d::UnitZ());
  return close_camera(cell.corners, forward + 0.45 * right, static_cast<double>(kWidth) / kHeight);
}

}  // namespace

lab::PaperFigure node_cases(const Work& work) {
  work.begin("node cases");
  const Frame frame = lab::make_sample_frame({.seed = work.results.seed}, 2).frame;
  const planes::PipelineOptions options = options_of(lab::with_ours({}, "paper", "gcn"), work);
  const planes::FrameResult result = planes::run_frame(frame, options, work.network.get());
  const planes::Octree& octree = result.segmentation.octree;

  lab::PaperFigure figure;
  figure.id = "node_cases";
  figure.title = "Cases of a node";
  figure.note = fmt::format(
      "One node of each case from one frame, boxes through the camera model, profile paper, labels "
      "of the 3D-GCN: its points inside its cell, h blue and v orange, what lies around it grey. "
      "To look into it: planescope synth sample --seed {} -o sample; planescope sample --profile "
      "paper, frame 2",
      work.results.seed);
  constexpr const char* kColumns[] = {"", "(a) Case I", "(b) Case II", "(c) Case III",
                                      "(d) Case IV"};
  for (const planes::Case c :
       {planes::Case::I, planes::Case::II, planes::Case::III, planes::Case::IV}) {
    const std::optional<std::int32_t> node = pick(octree, c, options.segment);
    if (!node) continue;
    const Judged judged = judge(octree, *node, options.segment);
    const render::Camera camera = camera_of(result, render::cell_box(octree, octree.nodes[*node]));
    add_picture(figure, "", kColumns[static_cast<int>(c)],
                fmt::format("Node {}. {}", *node, caption(c, judged, options.segment)),
                work.renderer.render(close_up(result, *node, judged), camera, kWidth, kHeight,
                                     render::Theme::light));
  }
  return figure;
}

}  // namespace planescope::app::figures
