// The paper's figure of a staircase with 10 planes, with and without pointwise classification, at
// two levels of noise: 10 / 10 and 13 / 19 planes there.

#include <fmt/format.h>

#include <cmath>

#include "app/lab/paper_figures/parts.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"

namespace planescope::app::figures {
namespace {

constexpr int kStairWidth = 600, kStairHeight = 640;
constexpr std::size_t kPlanes = 10;
constexpr int kMostStairs = 100;  // of the set; one in five has 10 planes

/// The first staircase of the set that has as many planes as the paper's.
int find_stairs(std::uint64_t seed) {
  lab::StairsOptions options;
  options.seed = seed;
  options.points = 64;  // the size does not depend on them
  for (int index = 0; index < kMostStairs; ++index)
    if (lab::make_stairs(index, options).normals.size() == kPlanes) return index;
  throw Error(fmt::format("seed {}: none of the first {} stairs has {} planes", seed, kMostStairs,
                          kPlanes));
}

Frame frame_of(const lab::Stairs& stairs) {
  Frame frame;
  frame.cloud = stairs.cloud;
  frame.gravity = Gravity{-Vec3d::UnitZ(), GravitySource::sidecar, 1, "stairs stand upright"};
  return frame;
}

/// From before the first step, to the side and above: every tread and every riser is seen.
Vec3d view_of(const lab::Stairs& stairs) {
  const double yaw = stairs.yaw_rad + 0.62;
  return {std::cos(yaw), std::sin(yaw), -0.62};
}

struct Scene {
  lab::Stairs stairs;
  Frame frame;
  planes::SourceTruth truth;
  std::string noise;  // "noise 0.3 cm"
  render::Camera camera;
};

Scene make_scene(int index, std::uint64_t seed, double noise_cm) {
  lab::StairsOptions options;
  options.seed = seed;
  options.noise_m = noise_cm / 100;
  Scene scene;
  scene.stairs = lab::make_stairs(index, options);
  scene.frame = frame_of(scene.stairs);
  scene.truth = *planes::truth_of_cloud(*scene.frame.cloud);
  scene.noise = fmt::format("noise {:.1f} cm", noise_cm);
  return scene;
}

void add_truth(lab::PaperFigure& figure, const Work& work, Scene& scene) {
  const PointSet& cloud = *scene.frame.cloud;
  scene.camera =
      close_camera(cloud.points, view_of(scene.stairs), double(kStairWidth) / kStairHeight);
  add_picture(figure, "truth", scene.noise + ", with PC",
              fmt::format("{} planes, {} points", kPlanes, cloud.points.size()),
              work.renderer.render(bare_planes(cloud.points, cloud.instance, {}), scene.camera,
                                   kStairWidth, kStairHeight, render::Theme::light));
}

void add_found(lab::PaperFigure& figure,
               const Work& work,
               const Scene& scene,
               const Contestant& contestant) {
  const bool with_labels = contestant.key.method == "ours" && contestant.key.classifier != "none";
  const std::string column = scene.noise + (with_labels ? ", with PC" : ", w/o PC");
  work.begin(contestant.name + ", " + column);
  const planes::PipelineOptions options = options_of(contestant.key, work);
  const planes::FrameResult result = planes::run_frame(scene.frame, options, work.network.get());
  const planes::JudgedFrame judged = planes::judge_frame(result, scene.truth);
  const std::vector<int> colors = colors_by_truth(judged, result.segmentation.planes.size());
  std::vector<Vec3f> points;  // where the file has them: all pictures share a camera
  for (const std::uint32_t source : result.cloud.source)
    points.push_back(scene.frame.cloud->points[source]);
  add_picture(figure, contestant.name, column, planes_text(result),
              work.renderer.render(bare_planes(points, result.plane_of, colors), scene.camera,
                                   kStairWidth, kStairHeight, render::Theme::light));
}

}  // namespace

lab::PaperFigure stairs_noise(const Work& work) {
  const std::uint64_t seed = work.results.seed;
  const int index = find_stairs(seed);
  lab::PaperFigure figure;
  figure.id = "stairs_noise";
  figure.title = "A staircase of 10 planes";
  figure.note = fmt::format(
      "With and without pointwise classification (PC). The paper found 10 and 10 planes with it, "
      "13 and 19 without. A found plane has the colour of the true plane it stands for, others "
      "have colours of their own, points in no plane are dark. Staircase {0} of seed {1}, labels "
      "of the 3D-GCN; rivals know no labels. To look into it: "
      "planescope-lab synth stairs --seed {1} --noise 0.003 -o stairs; planescope "
      "stairs/stairs_{0:03}.ply --voxel 0 --profile paper",
      index, seed);
  Scene scenes[] = {make_scene(index, seed, 0), make_scene(index, seed, 0.3)};
  for (Scene& scene : scenes) add_truth(figure, work, scene);
  const lab::CellKey frames = lab::stairs_of(seed, lab::StairsOptions{}.points, 0);
  std::vector<Contestant> contestants;
  for (const char* profile : {"paper", "paper-closest", "refined"})
    for (const char* labels : {"gcn", "none"})
      contestants.push_back({profile, lab::with_ours(frames, profile, labels)});
  contestants.push_back({"region growing", lab::with_rival(frames, "region-growing")});
  contestants.push_back({"RANSAC, 0.01 m", lab::with_rival(frames, "ransac")});
  for (const Contestant& contestant : contestants)
    for (const Scene& scene : scenes) add_found(figure, work, scene, contestant);
  return figure;
}

}  // namespace planescope::app::figures
