#include "core/lab/experiments/measure_cells.hpp"

#include <algorithm>
#include <cassert>
#include <map>

#include "core/lab/experiments/contest.hpp"
#include "core/lab/experiments/oracle_result.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/planes/pipeline/score.hpp"

namespace planescope::lab {
namespace {

/// Leaves out planes that are hidden or too small to be scored: points assigned to one of them
/// would make a plane that no true plane stands for.
std::vector<TruePolygon> polygons_in_view(const EvaluationFrame& frame,
                                          const planes::SourceTruth& truth,
                                          const planes::PreparedFrame& prepared,
                                          int min_voxels) {
  std::map<int, int> voxels;
  for (const std::int32_t plane : planes::vote_instances(
           prepared.voxels, planes::truth_on_points(truth.values, prepared.cloud.source).instance))
    ++voxels[plane];
  std::vector<TruePolygon> in_view = frame.polygons;
  std::erase_if(in_view, [&](const TruePolygon& polygon) {
    return polygon.plane > 0 && voxels[polygon.plane] < min_voxels;
  });
  return in_view;
}

std::vector<planes::Metrics> score_frame_of(const EvaluationFrame& frame,
                                            std::span<const CellKey> keys,
                                            const CellTools& tools) {
  const planes::SourceTruth truth = truth_of(frame);
  Contest contest(frame.frame, tools, &truth);
  const auto run = [&](const CellKey& key) {
    if (key.method != "oracle") return contest.run(key);
    const planes::PreparedFrame& prepared = contest.prepared("truth", key);
    return oracle_result(
        prepared, polygons_in_view(frame, truth, prepared, key.points > 0 ? 1 : kMinTruthVoxels));
  };
  std::vector<planes::Metrics> scores;
  for (const CellKey& key : keys)
    scores.push_back(key.points > 0 ? planes::score_frame(run(key), truth)
                                    : planes::score_voxels(run(key), truth, kMinTruthVoxels));
  return scores;
}

}  // namespace

EvaluationFrame cell_frame(const CellKey& key, int index, const CellTools& tools) {
  if (key.set == kRealLabelled) {
    assert(tools.real_labelled);
    return *tools.real_labelled;
  }
  EvaluationOptions options;
  options.seed = key.seed;
  options.points = key.points;
  options.noise_m = key.noise_cm / 100;
  if (!key.errors.empty()) options.errors = parse_depth_errors(key.errors);
  return make_evaluation_frame(find_evaluation_set(key.set), index, options);
}

std::vector<Cell> measure_cells(std::span<const CellKey> keys,
                                int frames,
                                const CellTools& tools,
                                const std::function<void(int, int)>& progress) {
  assert(std::ranges::all_of(keys, [&](const CellKey& key) { return same_frames(key, keys[0]); }));
  const auto scores = of_methods<planes::Metrics>(
      keys.size(), frames, tools.threads,
      [&](int index) { return score_frame_of(cell_frame(keys[0], index, tools), keys, tools); },
      progress);
  std::vector<Cell> cells;
  for (std::size_t k = 0; k < keys.size(); ++k)
    cells.push_back({keys[k], frames, planes::mean_of(scores[k])});
  return cells;
}

}  // namespace planescope::lab
