// planescope labels check, compare and stats.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/cli/progress.hpp"
#include "app/commands/labels.hpp"
#include "core/labels/review/audit.hpp"
#include "core/labels/review/carry.hpp"
#include "core/labels/review/review.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct CheckedFrame {
  int frame = 0;
  int width = 0;
  bool is_cloud = false;
  std::string file;
  std::string damage;  // empty: intact
  std::size_t planes = 0;
  std::vector<labels::Finding> findings;
};

/// Requires the recording.
labels::LabelGrid grid_as_drawn(const LabeledRecording& source,
                                int frame,
                                const FrameLabels& labels) {
  return labels::make_label_grid(
      frame_as_drawn(read_frame([&] { return source.recording->frame(source.frame(frame)); }),
                     source.recording->info(), labels),
      labels.gravity);
}

/// Common header of the JSON output of commands for one folder.
Json json_about(const char* schema, const LabeledRecording& source) {
  return {{"schema", schema},
          {"labels", source.labels.dir.string()},
          {"recording", source.recording ? Json(source.path.string()) : Json()},
          {"frames", Json::array()}};
}

CheckedFrame check_frame(const LabeledRecording& source, int frame) {
  CheckedFrame checked;
  checked.frame = frame;
  checked.file = (source.labels.dir / fmt::format("{:06}.json", frame)).string();
  try {
    const FrameLabels labels = read_labels_of(source, frame);
    checked.planes = labels.planes.size();
    checked.width = labels.plane.width;
    checked.is_cloud = labels.is_cloud();
    if (source.recording)
      checked.findings = labels::audit_labels(labels, grid_as_drawn(source, frame, labels));
  } catch (const Error& error) {
    checked.damage = error.what();
  }
  return checked;
}

std::string place_of(const labels::Finding& finding, const CheckedFrame& frame) {
  const auto pixel = static_cast<int>(finding.pixel);
  if (frame.is_cloud) return fmt::format("point {}", pixel);
  return fmt::format("pixel {},{}", pixel % frame.width, pixel / frame.width);
}

struct Counts {
  int findings = 0, hints = 0, damaged = 0;

  void add(const CheckedFrame& frame) {
    damaged += frame.damage.empty() ? 0 : 1;
    for (const labels::Finding& finding : frame.findings)
      ++(labels::is_hint(finding.kind) ? hints : findings);
  }
};

Json to_json(const labels::Finding& finding, int width) {
  const auto pixel = static_cast<int>(finding.pixel);
  return {{"kind", labels::to_string(finding.kind)},
          {"hint", labels::is_hint(finding.kind)},
          {"plane", finding.plane},
          {"pixel", {pixel % width, pixel / width}},
          {"pixels", finding.pixels.size()},
          {"value", finding.value},
          {"limit", finding.limit},
          {"text", finding.text}};
}

void print_json(const LabeledRecording& source,
                const std::vector<CheckedFrame>& frames,
                const Counts& counts) {
  Json json = json_about("planescope.labels_check/1", source);
  for (const CheckedFrame& frame : frames) {
    Json one = {{"frame", frame.frame}, {"file", frame.file}, {"planes", frame.planes}};
    one["damage"] = frame.damage.empty() ? Json(nullptr) : Json(frame.damage);
    one["findings"] = Json::array();
    for (const labels::Finding& finding : frame.findings)
      one["findings"].push_back(to_json(finding, frame.width));
    json["frames"].push_back(one);
  }
  json["findings"] = counts.findings;
  json["hints"] = counts.hints;
  json["damaged"] = counts.damaged;
  fmt::print("{}", json_text(json, 2));
}

/// Prints one line per finding. Returns 0 if there are none or only hints, 1 with findings (or
/// hints, if `strict`), 2 if files are damaged.
int run_labels_check(const LabelsArgs& args, const std::stop_token& stop) {
  const LabeledRecording source = open_labels(args);
  std::vector<CheckedFrame> frames;
  Counts counts;
  // Damage is a finding.
  (void)for_each_frame("check", source.labels.frames, stop, [&](int frame) {
    frames.push_back(check_frame(source, frame));
    counts.add(frames.back());
  });
  if (args.json) {
    print_json(source, frames, counts);
  } else {
    for (const CheckedFrame& frame : frames) {
      if (!frame.damage.empty()) fmt::print("{}\n", frame.damage);
      for (const labels::Finding& f : frame.findings)
        fmt::print("{}: frame {}: {}{}: {}, see {}\n", frame.file, frame.frame,
                   labels::is_hint(f.kind) ? "hint: " : "", labels::to_string(f.kind), f.text,
                   place_of(f, frame));
    }
    fmt::print("{}: {} labeled {}, {} damaged, {}\n", source.labels.dir.string(), frames.size(),
               frames.size() == 1 ? "frame" : "frames", counts.damaged,
               source.recording ? counted(static_cast<std::size_t>(counts.findings), "finding") +
                                      ", " + counted(static_cast<std::size_t>(counts.hints), "hint")
                                : "planes not checked: no recording found; use --recording");
  }
  if (counts.damaged > 0) return 2;
  return counts.findings > 0 || (args.strict && counts.hints > 0) ? 1 : 0;
}

}  // namespace

void define_labels_check(CLI::App* labels, Line& line) {
  CLI::App* check =
      labels->add_subcommand("check",
                             "Report damaged and suspicious labels, one per line\n"
                             "Exit code 0: hints at most; 1: findings; 2: damaged files.");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(check, *args, "Label folder or recording");
  add_label_dir(check, *args);
  check->add_flag("--strict", args->strict, "Also exit with 1 for hints");
  runs(check, line, args, run_labels_check);
}

namespace {

struct ComparedFrame {
  int frame = 0;
  labels::Agreement agreement;
};

/// Averages figures and adds up counts.
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

ComparedFrame compare_frame(const LabeledRecording& a, const LabeledRecording& b, int frame) {
  const FrameLabels of_a = read_labels_of(a, frame), of_b = read_labels_of(b, frame);
  if (of_a.depth_sha256 != of_b.depth_sha256)
    throw Error(fmt::format("{} and {}: labels of frame {} were created for different {}s",
                            a.labels.dir.string(), b.labels.dir.string(), frame,
                            of_a.is_cloud() ? "cloud" : "depth image"));
  return {frame, labels::agreement_of(of_a, of_b)};
}

/// Prints the agreement between two sets of labels for the same frames.
int run_labels_compare(const LabelsArgs& args, const std::stop_token& stop) {
  if (args.input.inputs.size() != 2)
    throw Error(fmt::format("labels compare: {}; expected two label folders",
                            counted(args.input.inputs.size(), "folder")));
  const auto open = [&](const std::filesystem::path& dir) {
    LabeledRecording source;
    source.labels = list_labels(dir);
    if (!args.recording.empty())
      source.recording = io::open_recording(args.recording, args.input.recording);
    return source;
  };
  const LabeledRecording a = open(args.input.inputs[0]), b = open(args.input.inputs[1]);
  std::vector<int> both, one;
  std::ranges::set_intersection(a.labels.frames, b.labels.frames, std::back_inserter(both));
  std::ranges::set_symmetric_difference(a.labels.frames, b.labels.frames, std::back_inserter(one));
  if (both.empty())
    throw Error(fmt::format("{} and {}: no frame has labels in both", a.labels.dir.string(),
                            b.labels.dir.string()));
  std::vector<ComparedFrame> frames;
  const DamagedFrames damaged = for_each_frame(
      "compare", both, stop, [&](int frame) { frames.push_back(compare_frame(a, b, frame)); });
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
    fmt::print("{}", json_text(json, 2));
    return damaged.report(both.size());
  }
  fmt::print("{:<7} {:>6} {:>6} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "frame", "in A", "in B",
             "matched", "IoU", "Rand", "h/v", "same", "pixels");
  for (const ComparedFrame& f : frames) print_row(std::to_string(f.frame), f.agreement);
  print_row("mean", mean);
  fmt::print(
      "\nin A, in B, matched: planes; IoU: mean over all planes of both, 0 for planes without a "
      "match;\n"
      "Rand: adjusted Rand index; h/v: share of pixels with the same class; same: with the same "
      "plane.\n");
  if (!one.empty())
    fmt::print("With labels in one folder only: {}.\n", counted(one.size(), "frame"));
  return damaged.report(both.size());
}

}  // namespace

void define_labels_compare(CLI::App* labels, Line& line) {
  CLI::App* compare =
      labels->add_subcommand("compare", "Measure how well two sets of labels agree");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(compare, *args, "Two label folders for the same frames");
  runs(compare, line, args, run_labels_compare);
}

namespace {

struct FrameStatistics {
  int frame = 0;
  std::string annotator, review_state;
  labels::LabelStatistics of;
  std::vector<labels::WorkTime> work;
  int doubtful = 0;  // number of doubtful planes

  double seconds() const {
    double sum = 0;
    for (const labels::WorkTime& w : work) sum += w.seconds;
    return sum;
  }
};

/// Counts pixels and planes without the recording; area and measured pixels need its depth.
labels::LabelStatistics count_pixels(const FrameLabels& labels) {
  labels::LabelGrid grid;
  grid.width = labels.plane.width;
  grid.height = labels.plane.height;
  grid.intrinsics = labels.intrinsics;
  grid.measured.assign(labels.plane.pixels(), 1);
  grid.points.assign(labels.plane.pixels(), Vec3f(0, 0, 1));
  labels::LabelStatistics statistics = labels::statistics_of(labels, grid);
  statistics.measured = 0;
  statistics.labeled_m2 = 0;
  return statistics;
}

std::string work_text(const std::vector<labels::WorkTime>& work) {
  std::string text;
  for (const labels::WorkTime& w : work)
    text += fmt::format("{}{} {} ({} gestures)", text.empty() ? "" : ", ", w.annotator,
                        minutes_text(w.seconds), w.gestures);
  return text.empty() ? "-" : text;
}

/// Remaining work, by frame.
struct Left {
  std::vector<int> unlabeled, unreviewed;
  std::vector<int> doubtful;  // frames with unedited carried planes
};

Left what_is_left(const LabeledRecording& source, const std::vector<FrameStatistics>& frames) {
  Left left;
  std::vector<int> labeled;
  for (const FrameStatistics& f : frames) {
    if (f.of.planes > 0) labeled.push_back(source.frame(f.frame));
    if (f.of.planes > 0 && f.review_state != "reviewed") left.unreviewed.push_back(f.frame);
    if (f.doubtful > 0) left.doubtful.push_back(f.frame);
  }
  std::ranges::sort(labeled);
  const int count = source.recording ? source.recording->frame_count() : 0;
  for (int i = 0; i < count; ++i)
    if (!std::ranges::binary_search(labeled, i)) left.unlabeled.push_back(i);
  return left;
}

/// Returns e.g. "5: 0-3, 7".
std::string frames_text(const std::vector<int>& frames) {
  std::string text = std::to_string(frames.size());
  for (std::size_t i = 0, end = 0; i < frames.size(); i = end) {
    for (end = i + 1; end < frames.size() && frames[end] == frames[end - 1] + 1;) ++end;
    text += fmt::format("{}{}", i == 0 ? ": " : ", ", frames[i]);
    if (end > i + 1) text += fmt::format("-{}", frames[end - 1]);
  }
  return text;
}

void print_left(const Left& left, bool with_recording) {
  fmt::print(
      "\nremaining frames\n"
      "  without labels: {}\n"
      "  not reviewed: {}\n",
      with_recording ? frames_text(left.unlabeled) : "unknown; use --recording RECORDING",
      frames_text(left.unreviewed));
  fmt::print("  with carried planes below {:.0f} % confidence, not yet edited: {}\n",
             100 * labels::kSure, frames_text(left.doubtful));
}

void print_table(const std::vector<FrameStatistics>& frames, bool with_depth) {
  fmt::print("{:<7} {:>6} {:>4} {:>4} {:>9} {:>9} {:>8} {:>9}  {:<10}  {}\n", "frame", "planes",
             "h", "v", "labeled", "measured", "ignored", "area m2", "review", "time");
  labels::LabelStatistics sum;
  double seconds = 0;
  const auto row = [&](const std::string& name, const labels::LabelStatistics& s,
                       const std::string& review, const std::string& time) {
    fmt::print("{:<7} {:>6} {:>4} {:>4} {:>9} {:>9} {:>8} {:>9}  {:<10}  {}\n", name, s.planes, s.h,
               s.v, s.labeled, with_depth ? fmt::format("{}", s.measured) : "-", s.ignored,
               with_depth ? fmt::format("{:.2f}", s.labeled_m2) : "-", review, time);
  };
  for (const FrameStatistics& f : frames) {
    row(std::to_string(f.frame), f.of, f.review_state, work_text(f.work));
    sum.planes += f.of.planes;
    sum.h += f.of.h;
    sum.v += f.of.v;
    sum.labeled += f.of.labeled;
    sum.measured += f.of.measured;
    sum.ignored += f.of.ignored;
    sum.labeled_m2 += f.of.labeled_m2;
    seconds += f.seconds();
  }
  row("sum", sum, "", minutes_text(seconds));
  if (!with_depth)
    fmt::print("\nmeasured, area: unknown without depth; use --recording RECORDING\n");
}

Json to_json(const FrameStatistics& f, bool with_depth) {
  Json json = {{"frame", f.frame},
               {"annotator", f.annotator},
               {"review_state", f.review_state},
               {"planes", f.of.planes},
               {"h", f.of.h},
               {"v", f.of.v},
               {"labelled", f.of.labeled},
               {"ignored", f.of.ignored},
               {"hidden", f.of.hidden},
               {"doubtful", f.doubtful}};
  json["measured"] = with_depth ? Json(f.of.measured) : Json(nullptr);
  json["labelled_m2"] = with_depth ? Json(f.of.labeled_m2) : Json(nullptr);
  json["work"] = Json::array();
  for (const labels::WorkTime& w : f.work)
    json["work"].push_back(
        {{"annotator", w.annotator}, {"seconds", w.seconds}, {"gestures", w.gestures}});
  return json;
}

/// Prints labeling progress: planes, area and time by frame.
int run_labels_stats(const LabelsArgs& args, const std::stop_token& stop) {
  const LabeledRecording source = open_labels(args);
  std::map<int, std::vector<labels::WorkTime>> work;
  for (const labels::WorkTime& w : labels::work_times(source.labels.dir))
    work[w.frame].push_back(w);
  std::vector<FrameStatistics> frames;
  const DamagedFrames damaged = for_each_frame("stats", source.labels.frames, stop, [&](int frame) {
    const FrameLabels labels = read_labels_of(source, frame);
    frames.push_back({frame, labels.annotator, labels.review_state, {}, work[frame], 0});
    frames.back().doubtful = static_cast<int>(std::ranges::count_if(
        labels.planes, [](const LabelPlane& plane) { return plane.confidence < labels::kSure; }));
    frames.back().of = source.recording
                           ? labels::statistics_of(labels, grid_as_drawn(source, frame, labels))
                           : count_pixels(labels);
  });
  if (!args.json) {
    print_table(frames, source.recording != nullptr);
    print_left(what_is_left(source, frames), source.recording != nullptr);
    return damaged.report(source.labels.frames.size());
  }
  Json json = json_about("planescope.labels_stats/1", source);
  for (const FrameStatistics& f : frames)
    json["frames"].push_back(to_json(f, source.recording != nullptr));
  const Left left = what_is_left(source, frames);
  json["left"] = {{"unlabelled", source.recording ? Json(left.unlabeled) : Json(nullptr)},
                  {"unreviewed", left.unreviewed},
                  {"doubtful", left.doubtful}};
  fmt::print("{}", json_text(json, 2));
  return damaged.report(source.labels.frames.size());
}

}  // namespace

void define_labels_stats(CLI::App* labels, Line& line) {
  CLI::App* stats = labels->add_subcommand(
      "stats", "Show the planes, labeled area, and annotation time of each frame");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(stats, *args, "Label folder or recording");
  add_label_dir(stats, *args);
  runs(stats, line, args, run_labels_stats);
}

}  // namespace planescope::app
