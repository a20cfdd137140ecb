// Runs, scores and times the contestants of the paper's experiments.

#include "core/lab/experiments/measure_paper.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/io/recording.hpp"
#include "core/lab/bench/measuring.hpp"
#include "core/lab/rivals/rivals.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

// ---- Cells ----

namespace {

/// Omits planes that are hidden or too small to be scored: points assigned to them would form a
/// plane without a true match.
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
    const planes::PreparedFrame& prepared =
        contest.prepared("truth", with_ours(key, "paper", "truth"));
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
  if (key.set == kRealLabeled) {
    assert(tools.real_labeled);
    return *tools.real_labeled;
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

// ---- The labeled frame ----

// One frame of ICL-NUIM (Handa et al. 2014), with the plane labels of EVOPS (Kornilova et al.
// 2022).

std::optional<EvaluationFrame> read_real_labeled(const std::filesystem::path& data) {
  const std::filesystem::path dir = data / "NOT_REAL_icl_nuim_with_plane_gt";
  if (data.empty() || !std::filesystem::is_directory(dir)) return std::nullopt;
  const auto recording = io::open_recording(
      dir, {.intrinsics = {{481.2, 480, 319.5, 239.5}}, .depth_unit_m = 0.0002, .color = false});
  EvaluationFrame out;
  out.frame = recording->frame(0);
  out.name = out.frame.name;
  out.frame.gravity = Gravity{Vec3d::UnitY(), GravitySource::sidecar, 1, "the camera is level"};
  const std::filesystem::path labels = dir / "gt_0.npy";
  out.labels = labels::labels_of_points(labels::read_labeled(labels, labels::LabelFormat::evops),
                                        labels::make_label_grid(out.frame, *out.frame.gravity),
                                        recording->frame_hash(0), labels.string());
  return out;
}

// ---- Timings ----

namespace {

constexpr double kTimedNoiseCm = 0.1;

std::vector<EvaluationFrame> stairs(const TimingOptions& options, int points, double noise_cm) {
  std::vector<EvaluationFrame> frames;
  for (int i = 0; i < options.rounds; ++i) {
    frames.push_back(cell_frame(clouds_of("stairs", options.seed, points, noise_cm), i, {}));
    if (options.before_turn) options.before_turn();
  }
  return frames;
}

std::function<void()> before(const TimingOptions& options) {
  return options.before_turn ? options.before_turn : [] {};
}

}  // namespace

void time_classifiers(const CellTools& tools, const TimingOptions& options, ResultLines& lines) {
  struct Contestant {
    const char* name;
    const planes::Classifier& classifier;
    int threads;
  };
  std::vector<Contestant> contestants;
  for (const int threads : std::set<int>{1, options.threads}) {
    contestants.push_back({"gcn", *tools.gcn, threads});
    contestants.push_back({"pca", *tools.pca, threads});
  }
  for (const int points : {2048, 4096, 8192}) {
    const std::vector<EvaluationFrame> frames = stairs(options, points, 0);
    const auto ms = interleaved_ms(
        contestants.size(), options.rounds, before(options), [&](std::size_t c, int round) {
          const EvaluationFrame& frame = frames[static_cast<std::size_t>(round)];
          contestants[c].classifier.classify(frame.frame.cloud->points, contestants[c].threads);
        });
    for (std::size_t c = 0; c < contestants.size(); ++c)
      lines.add("classifier_time", {{"classifier", contestants[c].name},
                                    {"points", points},
                                    {"threads", contestants[c].threads},
                                    {"median_ms", median(ms[c])}});
  }
}

void time_methods(const CellTools& tools, const TimingOptions& options, ResultLines& lines) {
  const CellKey frames_key = clouds_of("stairs", options.seed, 8192, kTimedNoiseCm);
  std::vector<CellKey> keys;
  for (const char* profile : {"paper", "refined"})
    for (const char* labels : {"gcn", "pca"})
      keys.push_back(with_ours(frames_key, profile, labels));
  for (const std::string& rival : rival_names(/*images=*/false))
    keys.push_back(with_rival(frames_key, rival));

  std::vector<planes::PipelineOptions> pipelines;
  for (const CellKey& key : keys) pipelines.push_back(cell_options(key));
  const std::vector<EvaluationFrame> frames = stairs(options, 8192, kTimedNoiseCm);
  const auto ms =
      interleaved_ms(keys.size(), options.rounds, before(options), [&](std::size_t c, int round) {
        const std::string& labels = keys[c].classifier;
        const planes::Classifier* classifier = labels == "gcn"   ? tools.gcn.get()
                                               : labels == "pca" ? tools.pca.get()
                                                                 : nullptr;
        run_method(frames[static_cast<std::size_t>(round)].frame, pipelines[c], classifier,
                   find_library_rival(keys[c].method));
      });
  for (std::size_t c = 0; c < keys.size(); ++c)
    lines.add("method_time", {{"key", json_of(keys[c])}, {"fps", 1000 / median(ms[c])}});
}

}  // namespace planescope::lab
