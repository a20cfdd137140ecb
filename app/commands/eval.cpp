// planescope eval: scores a segmentation, or labels made earlier, against ground truth.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/report/data/segment_files.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct EvalArgs {
  InputArgs input;
  std::filesystem::path prediction;  // scored instead of our own segmentation; empty: none
  bool json = false;
};

/// Reads the prediction for a frame from a folder: output of `planescope segment` (frames/000123),
/// label files, or an exchange format (000123.npy, .label, .npz, .ply, .pcd, .json;
/// annotations.json for all frames). `gravity` is that of the ground truth. nullopt if the folder
/// has no prediction for the frame. Throws Error if it is damaged or does not fit the frame.
std::optional<FrameLabels> read_prediction(const fs::path& dir,
                                           const io::Recording& recording,
                                           const Frame& frame,
                                           const Gravity& gravity) {
  const std::string hash = recording.frame_hash(frame.index);
  const std::string name = fmt::format("{:06}", frame.index);
  if (fs::exists(dir / (name + ".plane.png")))
    return labels::read_labels_of_frame(dir, frame, hash);
  std::vector<fs::path> candidates = {dir / report::frame_folder(frame.index) / "cloud.ply"};
  for (const char* ending : {".npy", ".label", ".npz", ".ply", ".pcd", ".json"})
    candidates.push_back(dir / (name + ending));
  for (const fs::path& path : candidates)
    if (fs::exists(path))
      return labels::labels_of_points(labels::read_labeled(path, labels::label_format_of(path)),
                                      labels::make_label_grid(frame, gravity), hash, path.string());
  if (const fs::path path = dir / labels::kCocoFileName; fs::exists(path)) {
    const labels::CocoFile coco = labels::read_coco(path);
    if (const auto image = coco.image_of_frame(frame.index))
      return labels::labels_of_points(coco.points(*image), labels::make_label_grid(frame, gravity),
                                      hash, path.string());
  }
  return std::nullopt;
}

struct Row {
  std::string input;
  int frame = 0;
  std::string name;
  planes::Metrics metrics;
};

Json to_json(const planes::Metrics& m) {
  Json json;
  planes::visit_values(m, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

/// Returns a dash if the truth or the result has no h and v labels.
std::string labels_right(double percent) {
  return std::isnan(percent) ? "-" : fmt::format("{:.2f}", percent);
}

void print_row(const std::string& name, int width, const planes::Metrics& m) {
  fmt::print(
      "{:<{}} {:>5} {:>5} {:>7.3f} {:>6.1f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>5} {:>5} {:>5} "
      "{:>6} {:>5} {:>6} {:>6}\n",
      name, width, m.planes_truth, m.planes_found, m.alpha_deg, m.r_p, m.r_m, m.point_accuracy,
      m.mean_iou, m.pq, m.detected_iou80, m.over_segmented, m.under_segmented, m.missed, m.noise,
      labels_right(m.label_accuracy_edge), labels_right(m.label_accuracy_inner));
}

void print_table(const std::vector<Row>& rows, const planes::Metrics& mean, int without_truth) {
  int width = 4;
  for (const Row& row : rows) width = std::max(width, static_cast<int>(row.name.size()));
  fmt::print(
      "{:<{}} {:>5} {:>5} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>5} {:>6} {:>5} {:>6} "
      "{:>6}\n",
      "frame", width, "true", "found", "alpha", "r_p", "r_m", "acc", "IoU", "PQ", "IoU80", "over",
      "under", "missed", "noise", "edge", "inner");
  std::string input;
  for (const Row& row : rows) {
    if (row.input != input) fmt::print("{}\n", row.input);
    input = row.input;
    print_row(row.name, width, row.metrics);
  }
  print_row("mean", width, mean);
  fmt::print(
      "\nalpha: degrees; r_p: 100 x found / true; r_m: % of unassigned points; acc, IoU: % for "
      "the\n"
      "best matching; PQ: panoptic quality, %; IoU80: planes found with IoU of at least 0.8; "
      "edge,\n"
      "inner: % of correct labels within 2 cm of a different label, and elsewhere. Counts in the\n"
      "last line are sums.\n");
  if (without_truth > 0)
    fmt::print("Without ground truth: {}.\n",
               counted(static_cast<std::size_t>(without_truth), "frame"));
}

std::string name_of(const Frame& frame) {
  return frame.name.empty() ? std::to_string(frame.index) : frame.name;
}

/// Scores our own segmentation; nullopt if the frame has no ground truth.
std::optional<Row> run_and_score(const OpenInput& input,
                                 int index,
                                 const planes::PipelineOptions& options,
                                 const planes::Classifier* classifier) {
  const LoadedFrame loaded = run_input_frame(input, index, options, classifier, true);
  if (!loaded.truth) return std::nullopt;
  return Row{input.path.string(), index, name_of(loaded.frame),
             planes::score_frame(loaded.result, *loaded.truth)};
}

/// Scores the labels in --prediction.
std::optional<Row> score_prediction(const OpenInput& input, int index, const EvalArgs& args) {
  const Frame frame = read_frame([&] { return input.recording->frame(index); });
  const std::optional<int> number = input.label_number(index);
  if (!number) return std::nullopt;
  const auto truth = labels::read_labels_of_frame(input.label_dir, frame,
                                                  input.recording->frame_hash(index), number);
  if (!truth) return std::nullopt;
  const auto found = read_prediction(args.prediction, *input.recording, frame, truth->gravity);
  if (!found)
    throw Error(
        fmt::format("{}: no planes for frame {}; expected a label file, such as {:06}.plane.png or "
                    "{:06}.npy, or the output of planescope segment",
                    args.prediction.string(), index, index, index));
  return Row{input.path.string(), index, name_of(frame),
             planes::score_labels(frame, *found, *truth, args.input.pipeline.cloud)};
}

/// Prints the metrics of each frame with ground truth, and their mean. Throws Error if no frame has
/// ground truth or a prediction is missing. Returns the exit code.
int run_eval(const EvalArgs& args, std::stop_token stop) {
  InputArgs depth_alone = args.input;
  depth_alone.recording.color = false;
  const std::vector<OpenInput> inputs = open_inputs(depth_alone);
  const bool predicted = !args.prediction.empty();
  if (predicted && inputs.size() != 1)
    throw Error(fmt::format("--prediction specifies one folder, but there are {} recordings",
                            inputs.size()));
  const planes::ChosenClassifier chosen =
      predicted ? planes::ChosenClassifier{} : choose_classifier(args.input.pipeline);
  std::vector<const OpenInput*> input_of;
  std::vector<int> frames;
  for (const OpenInput& input : inputs)
    for (const int index : input.frames) {
      input_of.push_back(&input);
      frames.push_back(index);
    }
  struct Scored {
    std::optional<Row> row;
    std::string refused;
  };
  const planes::FrameThreads threads =
      planes::threads_for_frames(args.input.pipeline, static_cast<int>(frames.size()));
  const auto make = [&](std::size_t i) -> Scored {
    const OpenInput& input = *input_of[i];
    if (!may_have_truth(input, frames[i])) return {};
    try {
      if (predicted) return {score_prediction(input, frames[i], args), ""};
      return {run_and_score(input, frames[i], threads.pipeline, chosen.classifier.get()), ""};
    } catch (const FrameRefused& refusal) {
      return {{}, refusal.what()};
    }
  };
  std::vector<Row> rows;
  std::vector<std::string> refused;
  int without_truth = 0;
  const DamagedFrames damaged =
      run_frames("eval", frames, threads.at_once, stop, make, [&](std::size_t, Scored&& scored) {
        if (!scored.refused.empty())
          refused.push_back(scored.refused);
        else if (!scored.row)
          ++without_truth;
        else
          rows.push_back(std::move(*scored.row));
      });
  if (stop.stop_requested()) throw Cancelled();
  if (rows.empty() && !refused.empty()) throw Error(refused.front());
  if (rows.empty())
    throw Error(
        fmt::format("{}: no frame has ground truth; expected labels in {}, or point clouds with "
                    "label and instance fields",
                    inputs.front().path.string(), inputs.front().label_dir.string()));
  for (const std::string& why : refused) notice("rejected: {}", why);
  std::vector<planes::Metrics> all;
  for (const Row& row : rows) all.push_back(row.metrics);
  const planes::Metrics mean = planes::mean_of(all);
  if (!args.json) {
    print_table(rows, mean, without_truth);
    return damaged.report(frames.size());
  }
  Json json;
  json["schema"] = "planescope.eval/1";
  json["method"] = predicted ? "prediction" : planes::to_string(args.input.pipeline.method);
  json["frames"] = Json::array();
  for (const Row& row : rows) {
    Json frame = {{"input", row.input}, {"frame", row.frame}, {"name", row.name}};
    frame.update(to_json(row.metrics));
    json["frames"].push_back(frame);
  }
  json["refused"] = refused;
  json["damaged"] = damaged.lines;
  json["frames_without_truth"] = without_truth;
  json["mean"] = to_json(mean);
  fmt::print("{}", json_text(json, 2));
  return damaged.report(frames.size());
}

}  // namespace

void define_eval(CLI::App& app, Line& line) {
  CLI::App* eval = app.add_subcommand(
      "eval", "Measure planes against ground truth: label files or cloud fields");
  const auto args = std::make_shared<EvalArgs>();
  add_recordings(eval, args->input, true);
  add_json(eval, args->json);
  add_method(eval, args->input.pipeline);
  add(eval, "--prediction", args->prediction, "DIR",
      "Score the planes in DIR instead: output of planescope segment, label files, or labels in "
      "another tool's format (docs/labels.md)");
  runs(eval, line, args, run_eval);
}

}  // namespace planescope::app
