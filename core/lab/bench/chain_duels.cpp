#include "core/lab/bench/chain_speed.hpp"
#include "core/planes/rivals/rival_classifiers.hpp"

namespace planescope::lab {
namespace {

struct Duel {
  std::string stage, rival;
  std::function<void()> ours, theirs;
};

std::vector<Duel> duels_of(const SpeedSubject& subject, std::size_t i, const SpeedTools& tools) {
  const planes::PipelineOptions options = ours_with(subject, planes::Profile::paper);
  const auto prepared = std::make_shared<const planes::PreparedFrame>(
      planes::prepare_frame(subject.frames[i], options, tools.pca.get()));
  const double voxel_m = options.cloud.voxel_size_m;
  std::vector<Duel> duels;
  if (tools.open3d_voxels && voxel_m > 0)
    duels.push_back({"voxel grid", "Open3D VoxelDownSample",
                     [prepared, voxel_m] { planes::voxelize(prepared->cloud, voxel_m); },
                     tools.open3d_voxels(prepared->cloud, voxel_m)});
  if (tools.open3d_octree) {
    // Ours leaves most nodes unmade; theirs has them all.
    const auto every_node = [prepared] {
      const planes::Cube& cube = prepared->cloud.cube;
      planes::Octree octree =
          planes::build_octree(prepared->voxels.points, prepared->classification.labels, cube);
      for (std::size_t node = 0; node < octree.nodes.size(); ++node)
        if (octree.nodes[node].depth < cube.max_depth)
          planes::divide(octree, static_cast<std::int32_t>(node));
    };
    duels.push_back({"octree, every node", "Open3D Octree", every_node,
                     tools.open3d_octree(prepared->voxels.points, prepared->cloud.cube)});
  }
  const std::shared_ptr<const planes::Classifier> nanoflann =
      planes::make_nanoflann_pca_classifier(tools.pca_options);
  duels.push_back({"classifier pca", "nanoflann and Eigen",
                   [prepared, pca = tools.pca] { pca->classify(prepared->voxels.points, 1); },
                   [prepared, nanoflann] { nanoflann->classify(prepared->voxels.points, 1); }});
  return duels;
}

}  // namespace

std::vector<DuelRow> measure_duels(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<std::vector<Duel>> of_frames;
  for (std::size_t i = 0; i < subject.frames.size(); ++i) {
    tools.before(subject.name);
    of_frames.push_back(duels_of(subject, i, tools));
  }
  const std::vector<Duel>& first = of_frames[0];
  const auto ms = interleaved_ms(
      2 * first.size(), tools.rounds, [&] { tools.before(subject.name); },
      [&](std::size_t turn, int round) {
        const Duel& duel = of_frames[static_cast<std::size_t>(round) % of_frames.size()][turn / 2];
        turn % 2 == 0 ? duel.ours() : duel.theirs();
      },
      Clock::thread_cpu);
  std::vector<DuelRow> rows;
  for (std::size_t d = 0; d < first.size(); ++d)
    rows.push_back({.recording = subject.name,
                    .stage = first[d].stage,
                    .rival = first[d].rival,
                    .ours_ms = times_of(ms[2 * d]),
                    .rival_ms = times_of(ms[2 * d + 1]),
                    .ratio = median_ratio(ms[2 * d + 1], ms[2 * d])});
  return rows;
}

}  // namespace planescope::lab
