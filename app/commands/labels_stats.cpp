#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/cli/progress.hpp"
#include "app/commands/labels.hpp"
#include "core/labels/review/audit.hpp"
#include "core/labels/review/carry.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct FrameStatistics {
  int frame = 0;
  std::string annotator, review_state;
  labels::LabelStatistics of;
  std::vector<labels::WorkTime> work;
  int doubtful = 0;  // planes

  double seconds() const {
    double sum = 0;
    for (const labels::WorkTime& w : work) sum += w.seconds;
    return sum;
  }
};

/// Pixels and planes without the recording; area and measured pixels need its depth.
labels::LabelStatistics count_pixels(const FrameLabels& labels) {
  labels::LabelGrid grid;
  grid.width = labels.plane.width;
  grid.height = labels.plane.height;
  grid.intrinsics = labels.intrinsics;
  grid.measured.assign(labels.plane.pixels(), 1);
  grid.points.assign(labels.plane.pixels(), Vec3f(0, 0, 1));
  labels::LabelStatistics statistics = labels::statistics_of(labels, grid);
  statistics.measured = 0;
  statistics.labelled_m2 = 0;
  return statistics;
}

std::string work_text(const std::vector<labels::WorkTime>& work) {
  std::string text;
  for (const labels::WorkTime& w : work)
    text += fmt::format("{}{} {} ({} gestures)", text.empty() ? "" : ", ", w.annotator,
                        minutes_text(w.seconds), w.gestures);
  return text.empty() ? "-" : text;
}

/// What of a recording is still to do, by frame.
struct Left {
  std::vector<int> unlabelled, unreviewed;
  std::vector<int> doubtful;  // with carried planes that nobody has touched
};

Left what_is_left(const LabelledRecording& source, const std::vector<FrameStatistics>& frames) {
  Left left;
  std::vector<int> labelled;
  for (const FrameStatistics& f : frames) {
    if (f.of.planes > 0) labelled.push_back(f.frame);
    if (f.of.planes > 0 && f.review_state != "reviewed") left.unreviewed.push_back(f.frame);
    if (f.doubtful > 0) left.doubtful.push_back(f.frame);
  }
  const int count = source.recording ? source.recording->frame_count() : 0;
  for (int i = 0; i < count; ++i)
    if (!std::ranges::binary_search(labelled, i)) left.unlabelled.push_back(i);
  return left;
}

/// "5: 0-3, 7"
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
  fmt::print("\nframes left to do\n  without labels: {}\n  not reviewed: {}\n",
             with_recording ? frames_text(left.unlabelled)
                            : "not known, --recording RECORDING says how many there are",
             frames_text(left.unreviewed));
  fmt::print("  with carried planes below {:.0f} % confidence, not yet edited: {}\n",
             100 * labels::kSure, frames_text(left.doubtful));
}

void print_table(const std::vector<FrameStatistics>& frames, bool with_depth) {
  fmt::print("{:<7} {:>6} {:>4} {:>4} {:>9} {:>9} {:>8} {:>9}  {:<10}  {}\n", "frame", "planes",
             "h", "v", "labelled", "measured", "ignored", "area m2", "review", "time");
  labels::LabelStatistics sum;
  double seconds = 0;
  const auto row = [&](const std::string& name, const labels::LabelStatistics& s,
                       const std::string& review, const std::string& time) {
    fmt::print("{:<7} {:>6} {:>4} {:>4} {:>9} {:>9} {:>8} {:>9}  {:<10}  {}\n", name, s.planes, s.h,
               s.v, s.labelled, with_depth ? fmt::format("{}", s.measured) : "-", s.ignored,
               with_depth ? fmt::format("{:.2f}", s.labelled_m2) : "-", review, time);
  };
  for (const FrameStatistics& f : frames) {
    row(std::to_string(f.frame), f.of, f.review_state, work_text(f.work));
    sum.planes += f.of.planes;
    sum.h += f.of.h;
    sum.v += f.of.v;
    sum.labelled += f.of.labelled;
    sum.measured += f.of.measured;
    sum.ignored += f.of.ignored;
    sum.labelled_m2 += f.of.labelled_m2;
    seconds += f.seconds();
  }
  row("sum", sum, "", minutes_text(seconds));
  if (!with_depth)
    fmt::print("\nmeasured, area: need the depth, --recording RECORDING says what was labelled\n");
}

Json to_json(const FrameStatistics& f, bool with_depth) {
  Json json = {{"frame", f.frame},
               {"annotator", f.annotator},
               {"review_state", f.review_state},
               {"planes", f.of.planes},
               {"h", f.of.h},
               {"v", f.of.v},
               {"labelled", f.of.labelled},
               {"ignored", f.of.ignored},
               {"hidden", f.of.hidden},
               {"doubtful", f.doubtful}};
  json["measured"] = with_depth ? Json(f.of.measured) : Json(nullptr);
  json["labelled_m2"] = with_depth ? Json(f.of.labelled_m2) : Json(nullptr);
  json["work"] = Json::array();
  for (const labels::WorkTime& w : f.work)
    json["work"].push_back(
        {{"annotator", w.annotator}, {"seconds", w.seconds}, {"gestures", w.gestures}});
  return json;
}

/// Where people have worked: planes, area and time by frame.
int run_labels_stats(const LabelsArgs& args, const std::stop_token& stop) {
  const LabelledRecording source = open_labels(args);
  std::map<int, std::vector<labels::WorkTime>> work;
  for (const labels::WorkTime& w : labels::work_times(source.labels.dir))
    work[w.frame].push_back(w);
  std::vector<FrameStatistics> frames;
  {
    Progress progress("stats", static_cast<int>(source.labels.frames.size()));
    for (const int frame : source.labels.frames) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(static_cast<int>(frames.size()), fmt::format("frame {}", frame));
      const FrameLabels labels = read_labels_of(source, frame);
      frames.push_back({frame, labels.annotator, labels.review_state, {}, work[frame], 0});
      frames.back().doubtful = static_cast<int>(std::ranges::count_if(
          labels.planes, [](const LabelPlane& plane) { return plane.confidence < labels::kSure; }));
      frames.back().of =
          source.recording
              ? labels::statistics_of(labels, labels::make_label_grid(
                                                  frame_as_drawn(source.recording->frame(frame),
                                                                 source.recording->info(), labels),
                                                  labels.gravity))
              : count_pixels(labels);
    }
  }
  if (!args.json) {
    print_table(frames, source.recording != nullptr);
    print_left(what_is_left(source, frames), source.recording != nullptr);
    return 0;
  }
  Json json = {{"schema", "planescope.labels_stats/1"}, {"labels", source.labels.dir.string()}};
  json["recording"] = source.recording ? Json(source.path.string()) : Json(nullptr);
  json["frames"] = Json::array();
  for (const FrameStatistics& f : frames)
    json["frames"].push_back(to_json(f, source.recording != nullptr));
  const Left left = what_is_left(source, frames);
  json["left"] = {{"unlabelled", source.recording ? Json(left.unlabelled) : Json(nullptr)},
                  {"unreviewed", left.unreviewed},
                  {"doubtful", left.doubtful}};
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace

void define_labels_stats(CLI::App* labels, Line& line) {
  CLI::App* stats =
      labels->add_subcommand("stats", "Planes, labelled area, and who worked how long, by frame");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(stats, *args, "A folder of labels, or a recording");
  add_label_dir(stats, *args);
  runs(stats, line, args, run_labels_stats);
}

}  // namespace planescope::app
