#include "core/lab/synthetic/scan.hpp"

#include <algorithm>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {
namespace {

enum ScanStream : std::uint64_t { kView = 1, kCamera = 2, kTestScene = 3, kComposedTest = 104 };

bool is_worth_learning(const planes::LabelledCloud& scan) {
  constexpr std::size_t kLeastVoxels = 300;
  const auto h = std::count(scan.labels.begin(), scan.labels.end(), Label::h);
  return scan.labels.size() >= kLeastVoxels && h > 0 && h < std::ssize(scan.labels);
}

D435Model usual_camera() {
  D435Model model;
  model.color = false;
  return model;
}

/// One in ten exact, the others with half to one and a half times the usual noise.
D435Model varied_camera(std::uint64_t seed) {
  D435Model model = usual_camera();
  model.noise = random_uniform(seed, kCamera, 0) >= 0.1;
  model.disparity_sigma_px = 0.03 + 0.09 * random_uniform(seed, kCamera, 1);
  return model;
}

/// Half of them with what real cameras add.
D435Model real_camera(std::uint64_t seed) {
  D435Model model = varied_camera(seed);
  if (random_uniform(seed, kCamera, 2) < 0.5) return model;
  model.bow_sigma_px = 0.12 * random_uniform(seed, kCamera, 3);
  model.bow_px = 24 + static_cast<int>(56 * random_uniform(seed, kCamera, 4));
  model.flying_from = 2 * random_uniform(seed, kCamera, 5);
  model.blind_from = 1.3 + 2 * random_uniform(seed, kCamera, 6);
  return model;
}

constexpr double kRange_m = planes::CloudOptions{}.max_range_m;

double usual_range_m(std::uint64_t /*seed*/) { return kRange_m; }

/// One in two as commands crop by default, the others farther.
double real_range_m(std::uint64_t seed) {
  return std::max(kRange_m, 4 * random_uniform(seed, kCamera, 7) - 0.5);
}

/// The first view of a composed scene that is worth learning.
planes::LabelledCloud scan_composed_scene(std::uint64_t seed,
                                          double voxel_size_m,
                                          D435Model (*camera)(std::uint64_t),
                                          double (*range_m)(std::uint64_t),
                                          bool mark_edges) {
  for (std::uint64_t view = 0;; ++view) {
    const std::uint64_t view_seed = random_bits(seed, kView, view);
    const Scene scene = compose_scene(view_seed);
    planes::LabelledCloud scan = make_scan(scene, camera(view_seed), voxel_size_m, view_seed,
                                           mark_edges, range_m(view_seed));
    if (is_worth_learning(scan)) return scan;
  }
}

}  // namespace

planes::LabelledCloud make_scan(const Scene& scene,
                                const D435Model& model,
                                double voxel_size_m,
                                std::uint64_t seed,
                                bool mark_edges,
                                double max_range_m) {
  FrameLabels truth;
  const Frame frame = render_scene(scene, scene.camera, model, seed, &truth);
  const planes::Cloud cloud =
      planes::make_cloud(frame, truth.gravity, {.max_range_m = max_range_m});
  const planes::VoxelCloud voxels = planes::voxelize(cloud, voxel_size_m);
  std::vector<std::uint8_t> labels;
  labels.reserve(cloud.source.size());
  for (const std::uint32_t pixel : cloud.source) labels.push_back(truth.hv.data[pixel]);

  planes::LabelledCloud scan;
  scan.kind = "scan";
  const std::vector<std::uint8_t> votes = planes::vote_labels(voxels, labels);
  for (std::size_t v = 0; v < votes.size(); ++v) {
    if (votes[v] == 0) continue;
    scan.points.push_back(voxels.points[v]);
    scan.labels.push_back(static_cast<Label>(votes[v]));
  }
  if (!mark_edges) return scan;
  std::vector<Label> measured;
  for (const std::uint8_t label : labels)
    measured.push_back(label <= 2 ? static_cast<Label>(label) : Label::unknown);
  scan.near_edge = planes::near_other_label(scan.points, scan.labels, cloud.points, measured);
  return scan;
}

planes::LabelledCloud make_training_scan(std::uint64_t seed,
                                         double voxel_size_m,
                                         bool real_errors) {
  return scan_composed_scene(seed, voxel_size_m, real_errors ? real_camera : varied_camera,
                             real_errors ? real_range_m : usual_range_m, /*mark_edges=*/false);
}

planes::LabelledCloud make_composed_test_scan(std::uint64_t seed, int index, double voxel_size_m) {
  const std::uint64_t scan_seed =
      random_bits(seed, kComposedTest, static_cast<std::uint64_t>(index));
  return scan_composed_scene(
      scan_seed, voxel_size_m, [](std::uint64_t) { return usual_camera(); }, usual_range_m,
      /*mark_edges=*/true);
}

planes::LabelledCloud make_test_scan(std::uint64_t seed, int index, double voxel_size_m) {
  const auto i = static_cast<std::uint64_t>(index);
  const std::uint64_t scan_seed = random_bits(seed, kTestScene, i);
  const Scene scene = make_scene(scene_names()[i % scene_names().size()], scan_seed);
  return make_scan(scene, usual_camera(), voxel_size_m, scan_seed, /*mark_edges=*/true);
}

std::vector<planes::LabelledCloud> make_test_scans(std::uint64_t seed,
                                                   int count,
                                                   double voxel_size_m,
                                                   int threads) {
  std::vector<planes::LabelledCloud> scans(static_cast<std::size_t>(count));
  const auto make = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      scans[i] = make_test_scan(seed, static_cast<int>(i), voxel_size_m);
  };
  parallel_for(scans.size(), threads, make, 1);
  return scans;
}

}  // namespace planescope::lab
