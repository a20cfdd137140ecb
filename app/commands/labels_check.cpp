#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/progress.hpp"
#include "app/commands/labels.hpp"
#include "core/labels/review/audit.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct CheckedFrame {
  int frame = 0;
  int width = 0;
  bool is_cloud = false;
  std::string file;
  std::string damage;  // empty: none
  std::size_t planes = 0;
  std::vector<labels::Finding> findings;
};

CheckedFrame check_frame(const LabelledRecording& source, int frame) {
  CheckedFrame checked;
  checked.frame = frame;
  checked.file = (source.labels.dir / fmt::format("{:06}.json", frame)).string();
  try {
    const FrameLabels labels = read_labels_of(source, frame);
    checked.planes = labels.planes.size();
    checked.width = labels.plane.width;
    checked.is_cloud = labels.is_cloud();
    if (source.recording)
      checked.findings = labels::audit_labels(
          labels, labels::make_label_grid(frame_as_drawn(source.recording->frame(frame),
                                                         source.recording->info(), labels),
                                          labels.gravity));
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

void print_json(const LabelledRecording& source,
                const std::vector<CheckedFrame>& frames,
                const Counts& counts) {
  Json json = {{"schema", "planescope.labels_check/1"}, {"labels", source.labels.dir.string()}};
  json["recording"] = source.recording ? Json(source.path.string()) : Json(nullptr);
  json["frames"] = Json::array();
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
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// One line per finding. Returns 0 where all is well or only hints were found, 1 with findings (or
/// hints, if `strict`), 2 where files are damaged.
int run_labels_check(const LabelsArgs& args, const std::stop_token& stop) {
  const LabelledRecording source = open_labels(args);
  std::vector<CheckedFrame> frames;
  Counts counts;
  {
    Progress progress("check", static_cast<int>(source.labels.frames.size()));
    for (const int frame : source.labels.frames) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(static_cast<int>(frames.size()), fmt::format("frame {}", frame));
      frames.push_back(check_frame(source, frame));
      counts.add(frames.back());
    }
  }
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
    fmt::print("{}: {} labelled {}, {} damaged, {}\n", source.labels.dir.string(), frames.size(),
               frames.size() == 1 ? "frame" : "frames", counts.damaged,
               source.recording ? counted(static_cast<std::size_t>(counts.findings), "finding") +
                                      ", " + counted(static_cast<std::size_t>(counts.hints), "hint")
                                : "planes not checked: no recording found, give --recording");
  }
  if (counts.damaged > 0) return 2;
  return counts.findings > 0 || (args.strict && counts.hints > 0) ? 1 : 0;
}

}  // namespace

void define_labels_check(CLI::App* labels, Line& line) {
  CLI::App* check = labels->add_subcommand("check",
                                           "What is damaged or looks wrong, a line each. Exit code "
                                           "0 nothing but hints,\n1 findings, 2 damaged files");
  const auto args = std::make_shared<LabelsArgs>();
  add_label_inputs(check, *args, "A folder of labels, or a recording");
  add_label_dir(check, *args);
  check->add_flag("--strict", args->strict, "Exit code 1 for hints, too");
  runs(check, line, args, run_labels_check);
}

}  // namespace planescope::app
