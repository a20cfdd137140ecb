#include "core/experiments/measure_cells.hpp"

#include <algorithm>
#include <cassert>
#include <map>

#include "core/base/work_list.hpp"
#include "core/experiments/oracle_result.hpp"
#include "core/experiments/paper_plan.hpp"
#include "core/pipeline/score.hpp"

namespace planescope {
namespace {

SourceTruth truth_of(const EvaluationFrame& frame) {
  SourceTruth truth =
      frame.labels ? truth_of_labels(*frame.labels) : *truth_of_cloud(*frame.frame.cloud);
  if (!frame.normals.empty()) truth.normals = frame.normals;  // exact ones, where they are known
  return truth;
}

/// One frame and all methods that find planes in it. Points are labelled once for all profiles.
class Contest {
 public:
  Contest(const EvaluationFrame& frame, const CellTools& tools)
      : frame_(frame),
        tools_(tools),
        truth_(truth_of(frame)),
        on_points_(truth_on_points(truth_.values, measured_sources(frame.frame))) {}

  Metrics score(const CellKey& key) {
    const FrameResult result = run(key);
    return key.points > 0 ? score_frame(result, truth_)
                          : score_voxels(result, truth_, kMinTruthVoxels);
  }

 private:
  FrameResult run(const CellKey& key) {
    if (key.method == "oracle") {
      const PreparedFrame& prepared = this->prepared("truth", key);
      return oracle_result(prepared,
                           polygons_in_view(prepared, key.points > 0 ? 1 : kMinTruthVoxels));
    }
    const PipelineOptions options = cell_options(key);
    if (options.method != Method::ours) return run_frame(frame_.frame, options, nullptr);
    FrameResult result{prepared(key.classifier, key), {}, {}};
    FoundRegions found = find_regions(frame_.frame, result, options);
    result.segmentation = std::move(found.segmentation);
    result.plane_of = std::move(found.plane_of);
    return result;
  }

  /// Leaves out planes that are hidden or too small to be scored: points assigned to one of them
  /// would make a plane that no true plane stands for.
  std::vector<TruePolygon> polygons_in_view(const PreparedFrame& prepared, int min_voxels) const {
    std::map<int, int> voxels;
    for (const std::int32_t plane : vote_instances(
             prepared.voxels, truth_on_points(truth_.values, prepared.cloud.source).instance))
      ++voxels[plane];
    std::vector<TruePolygon> in_view = frame_.polygons;
    std::erase_if(in_view, [&](const TruePolygon& polygon) {
      return polygon.plane > 0 && voxels[polygon.plane] < min_voxels;
    });
    return in_view;
  }

  const PreparedFrame& prepared(const std::string& labels, const CellKey& key) {
    const auto [at, is_new] = prepared_.try_emplace(labels);
    if (!is_new) return at->second;
    const Classifier* classifier =  // without labels: any will do, they are not used
        labels == "gcn"   ? tools_.gcn.get()
        : labels == "pca" ? tools_.pca.get()
                          : nullptr;
    at->second = prepare_frame(frame_.frame, cell_options(with_ours(key, "refined", labels)),
                               classifier, &on_points_);
    return at->second;
  }

  const EvaluationFrame& frame_;
  const CellTools& tools_;
  SourceTruth truth_;
  FrameTruth on_points_;
  std::map<std::string, PreparedFrame> prepared_;  // by the source of its labels
};

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
  // [keys][frames], so that those of a cell lie side by side
  const auto count = static_cast<std::size_t>(frames);
  std::vector<Metrics> of_frames(keys.size() * count);
  const auto measure = [&](int index) {
    const EvaluationFrame frame = cell_frame(keys[0], index, tools);
    Contest contest(frame, tools);
    for (std::size_t k = 0; k < keys.size(); ++k)
      of_frames[k * count + static_cast<std::size_t>(index)] = contest.score(keys[k]);
  };
  work_through(frames, tools.threads, measure, progress);

  std::vector<Cell> cells;
  for (std::size_t k = 0; k < keys.size(); ++k)
    cells.push_back({keys[k], frames, mean_of(std::span(of_frames).subspan(k * count, count))});
  return cells;
}

}  // namespace planescope
