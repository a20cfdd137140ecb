#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/progress.hpp"
#include "app/commands/labels.hpp"
#include "core/labels/review/review.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct ComparedFrame {
  int frame = 0;
  labels::Agreement agreement;
};

/// Means of the figures; counts are added up.
labels::Agreement mean_of(const std::vector<ComparedFrame>& frames) {
  labels::Agreement mean;
  const auto n = static_cast<double>(frames.size());
  for (const ComparedFrame& f : frames) {
    mean.mean_iou += f.agreement.mean_iou / n;
    mean.adjusted_rand += f.agreement.adjusted_rand / n;
    mean.label_accuracy += f.agreement.label_accuracy / n;
    mean.pixel_agreement += f.agreement.pixel_agreement / n;
    mean.planes_a += f.agreement.planes_a;
    mean.planes_b += f.agreement.planes_b;
    mean.matched += f.agreement.matched;
    mean.pixels += f.agreement.pixels;
  }
  return mean;
}

Json to_json(const labels::Agreement& a) {
  return {{"mean_iou", a.mean_iou},
          {"adjusted_rand", a.adjusted_rand},
          {"label_accuracy", a.label_accuracy},
          {"pixel_agreement", a.pixel_agreement},
          {"planes_a", a.planes_a},
          {"planes_b", a.planes_b},
          {"matched", a.matched},
          {"pixels", a.pixels}};
}

void print_row(const std::string& name, const labels::Agreement& a) {
  fmt::print("{:<7} {:>6} {:>6} {:>7} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>9}\n", name,
             a.planes_a, a.planes_b, a.matched, a.mean_iou, a.adjusted_rand, a.label_accuracy,
             a.pixel_agreement, a.pixels);
}

ComparedFrame compare_frame(const LabelledRecording& a, const LabelledRecording& b, int frame) {
  const FrameLabels of_a = read_labels_of(a, frame), of_b = read_labels_of(b, frame);
  if (of_a.depth_sha256 != of_b.depth_sha256)
    throw Error(fmt::format("{} and {}: labels of frame {} were made for different {}s",
                            a.labels.dir.string(), b.labels.dir.string(), frame,
                            of_a.is_cloud() ? "cloud" : "depth image"));
  return {frame, labels::agreement_of(of_a, of_b)};
}

/// How far two sets of labels of the same frames agree.
int run_labels_compare(const LabelsArgs& args, const std::stop_token& stop) {
  if (args.input.inputs.size() != 2)
    throw Error(fmt::format("labels compare: {} folders are given, expected two, DIR_A and DIR_B",
                            args.input.inputs.size()));
  const auto open = [&](const std::filesystem::path& dir) {
    LabelledRecording source;
    source.labels = list_labels(dir);
    if (!args.recording.empty())
      source.recording = io::open_recording(args.recording, args.input.recording);
    return source;
  };
  const LabelledRecording a = open(args.input.inputs[0]), b = open(args.input.inputs[1]);
  std::vector<int> both, one;
  std::ranges::set_intersection(a.labels.frames, b.labels.frames, std::back_inserter(both));
  std::ranges::set_symmetric_difference(a.labels.frames, b.labels.frames, std::back_inserter(one));
  if (both.empty())
    throw Error(fmt::format("{} and {}: no frame has labels in both", a.labels.dir.string(),
                            b.labels.dir.string()));
  std::vector<ComparedFrame> frames;
  {
    Progress progress("compare", static_cast<int>(both.size()));
    for (const int frame : both) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(static_cast<int>(frames.size()), fmt::format("frame {}", frame));
      frames.push_back(compare_frame(a, b, frame));
    }
  }
  const labels::Agreement mean = mean_of(frames);
  if (args.json) {
    Json json = {{"schema", "planescope.labels_compare/1"},
                 {"a", a.labels.dir.string()},
                 {"b", b.labels.dir.string()},
                 {"frames", Json::array()}};
    for (const ComparedFrame& f : frames) {
      json["frames"].push_back({{"frame", f.frame}});
      json["frames"].back().update(to_json(f.agreement));
    }
    json["frames_in_one_only"] = one;
    json["mean"] = to_json(mean);
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
    return 0;
  }
  fmt::print("{:<7} {:>6} {:>6} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "frame", "in A", "in B",
             "matched", "IoU", "Rand", "h/v", "same", "pixels");
  for (const ComparedFrame& f : frames) print_row(std::to_string(f.frame), f.agreement);
  print_row("mean", mean);
  fmt::print(
      "\nin A, in B, matched: planes; IoU: mean over all planes of both, 0 where one has no "
      "partner;\nRand: adjusted Rand index; h/v: share of pixels with the same class; same: with "
      "the same plane.\n");
  if (!one.empty())
    fmt::print("With labels in one folder only: {}.\n", counted(one.size(), "frame"));
  return 0;
}

}  // namespace

void define_labels_compare(CLI::App* labels, Line& line) {
  CLI::App* compare =
      labels->add_subcommand("compare", "How far two sets of labels of the same frames agree");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(compare, *args, "Two folders of labels, DIR_A and DIR_B");
  runs(compare, line, args, run_labels_compare);
}

}  // namespace planescope::app
