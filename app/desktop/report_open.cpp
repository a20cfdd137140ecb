#include "app/desktop/report_open.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/assets.hpp"
#include "app/desktop/actions.hpp"
#include "app/desktop/report_arrival.hpp"
#include "app/desktop/session.hpp"
#include "core/base/error.hpp"
#include "core/base/sha256.hpp"
#include "core/labels/label_files.hpp"
#include "core/pipeline/classifiers.hpp"
#include "core/pipeline/options_table.hpp"
#include "core/report/compare_reports.hpp"
#include "core/report/recorded_options.hpp"
#include "core/report/report_target.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

/// As it was typed, from the folders on in which the report lies, or beside it; nothing where none
/// is there. It was typed where the report was run, often some folders above it.
std::optional<fs::path> find_file(const fs::path& typed, const fs::path& report) {
  std::error_code none;
  if (fs::exists(typed, none)) return typed;
  const fs::path folder = fs::absolute(report).parent_path();
  for (fs::path above = folder;; above = above.parent_path()) {
    if (fs::exists(above / typed, none)) return above / typed;
    if (above == above.parent_path()) break;
  }
  const fs::path beside =
      folder / (typed.has_filename() ? typed.filename() : typed.parent_path().filename());
  if (fs::exists(beside, none)) return beside;
  return {};
}

const RecordedRecording& recording_of(const RecordedReport& report, const ReportTarget& target) {
  const auto count = report.recordings.size();
  if (static_cast<std::size_t>(target.recording) > count)
    throw Error(fmt::format("{}: r{} is not in it, it has {} recording{}", target.file.string(),
                            target.recording, count, count == 1 ? "" : "s"));
  return report.recordings[static_cast<std::size_t>(target.recording) - 1];
}

const RecordedFrame& frame_of(const RecordedRecording& recording, const ReportTarget& target) {
  std::vector<int> numbers;
  for (const RecordedFrame& frame : recording.frames) {
    if (target.frame < 0 || frame.index == target.frame) return frame;
    numbers.push_back(frame.index);
  }
  constexpr std::size_t kMost = 12;
  const bool more = numbers.size() > kMost;
  if (more) numbers.resize(kMost);
  throw Error(fmt::format("{}: f{} is not in it, of {} it has frame {}{}", target.file.string(),
                          std::max(0, target.frame), recording.name, fmt::join(numbers, ", "),
                          more ? ", ..." : ""));
}

/// `file`: whose frame it is.
void expect_plane(const RecordedFrame& frame, const ReportTarget& target, const fs::path& file) {
  const char* letters = target.of_baseline ? "was" : "p";
  const auto count = frame.planes.size();
  if (!frame.refused.empty())
    throw Error(fmt::format("{}: {}{} is not in it, frame {} was refused: {}", file.string(),
                            letters, target.plane, frame.index, frame.refused));
  if (static_cast<std::size_t>(target.plane) > count)
    throw Error(fmt::format("{}: {}{} is not in it, frame {} has {} plane{}", file.string(),
                            letters, target.plane, frame.index, count, count == 1 ? "" : "s"));
}

void add_note(std::string& note, const std::string& more) {
  note += (note.empty() ? "" : "; ") + more;
}

/// What the report's run was made with. Throws Error where that cannot be had any more; of what
/// may be another, `note` tells.
PipelineOptions options_from(const RecordedReport& report,
                             const fs::path& file,
                             std::string& note) {
  std::vector<std::string> unknown;
  PipelineOptions options;
  try {
    options = options_of(report, unknown);
  } catch (const Error& error) {
    throw Error(file.string() + ": its options cannot be taken: " + error.what());
  }
  if (!unknown.empty())
    add_note(note, fmt::format("{} has options that are no more: {}", file.filename().string(),
                               fmt::join(unknown, ", ")));
  if (report.weights_sha256.empty() || options.method != Method::ours) return options;
  if (!names_weights_file(options.classifier)) {
    const fs::path shipped =
        find_asset("classifier.safetensors", "the weights of classifier gcn are");
    if (sha256_hex_of_file(shipped) != report.weights_sha256)
      add_note(note, fmt::format("the weights of {} are not those of {}", options.classifier,
                                 file.filename().string()));
    return options;
  }
  const auto weights = find_file(options.classifier, file);
  if (!weights)
    throw Error(fmt::format("{}: its weights {} are neither there nor beside it", file.string(),
                            options.classifier));
  if (sha256_hex_of_file(*weights) != report.weights_sha256)
    throw Error(fmt::format("{}: are other weights than those of {}, SHA-256 differs",
                            weights->string(), file.string()));
  options.classifier = weights->string();
  return options;
}

/// Throws Error where it is another recording than the report's.
void expect_same_frame(const OpenRecording& open,
                       const RecordedFrame& frame,
                       const fs::path& report) {
  const int count = open.recording->frame_count();
  if (frame.index >= count)
    throw Error(
        fmt::format("{}: is another recording than that of {}: it has {} frames, expected "
                    "frame {}",
                    open.path.string(), report.string(), count, frame.index));
  const std::string found = open.recording->frame_hash(frame.index);
  if (!frame.sha256.empty() && found != frame.sha256)
    throw Error(
        fmt::format("{}: is another recording than that of {}: frame {} has SHA-256 {}, "
                    "expected {}",
                    open.path.string(), report.string(), frame.index, found, frame.sha256));
}

/// The report says of a damaged frame what it is; the others can be seen.
OpenRecording open_tolerant(const fs::path& path,
                            RecordingOptions options,
                            const fs::path& label_dir) {
  options.damaged_frames_later = true;
  return {path, open_recording(path, options), label_dir};
}

OpenRecording open_recorded(const State& state,
                            const RecordedRecording& recorded,
                            const RecordedFrame& frame,
                            const ReportLink& link,
                            const fs::path& report) {
  const std::vector<OpenRecording>& given = state.document.recordings;
  for (const OpenRecording& open : given) {
    const fs::path path = fs::absolute(open.path).lexically_normal();
    const bool of_this_name =
        (path.has_filename() ? path : path.parent_path()).filename() == recorded.name;
    if (!of_this_name && !(link.only_given && given.size() == 1)) continue;
    OpenRecording again =
        open_tolerant(open.path, state.document.recording_options, open.label_dir);
    expect_same_frame(again, frame, report);
    return again;
  }
  const auto path = find_file(recorded.path, report);
  if (!path || link.only_given)
    throw Error(
        fmt::format("{}: its recording {} is {}; give it: planescope view RECORDING --open {}",
                    report.string(), recorded.path.string(),
                    link.only_given ? "none of those that were given"
                                    : "neither there nor in or above the report's folder",
                    report.string()));
  OpenRecording open =
      open_tolerant(*path, recorded.options, link.label_dir.value_or(default_label_dir(*path)));
  expect_same_frame(open, frame, report);
  return open;
}

bool same_options(const PipelineOptions& a, const PipelineOptions& b) {
  return std::ranges::all_of(option_table(), [&](const OptionInfo& info) {
    return info.get(a) == info.get(b) || !info.matters(b);
  });
}

/// The baseline of a report, where there is one.
struct Baseline {
  fs::path file;
  RecordedReport report;
};

std::optional<Baseline> baseline_of(const RecordedReport& report,
                                    const ReportLink& link,
                                    const ReportTarget& target,
                                    std::string& note) {
  const fs::path& typed = link.baseline.empty() ? report.baseline : link.baseline;
  if (typed.empty()) {
    if (target.of_baseline)
      throw Error(fmt::format("{}: was{} is of a baseline, but it names none; give --baseline FILE",
                              target.file.string(), target.plane));
    return {};
  }
  const auto file = link.baseline.empty() ? find_file(typed, target.file) : typed;
  if (!file) {
    if (target.of_baseline)
      throw Error(
          fmt::format("{}: its baseline {} is neither there nor in or above its folder; "
                      "give --baseline FILE",
                      target.file.string(), typed.string()));
    add_note(note, fmt::format("no A: the baseline {} is not there; give --baseline FILE",
                               typed.string()));
    return {};
  }
  Baseline baseline{*file, read_report(*file)};
  if (target.of_baseline && baseline.report.created_utc == report.created_utc &&
      baseline.report.command == report.command)
    throw Error(fmt::format("{}: is {} itself, approved since: was{} was of an earlier baseline",
                            file->string(), target.file.string(), target.plane));
  return baseline;
}

/// The frame as the baseline has it, and what became of the plane.
void find_fate(const Baseline& baseline,
               const RecordedReport& report,
               const RecordedFrame& frame,
               const ReportTarget& target,
               ReportPlace& place) {
  const ReportComparison comparison = compare_reports(baseline.report, report);
  const auto same = std::ranges::find(comparison.frames, &frame, &FrameComparison::now);
  const bool usable = same->baseline && same->fate != FrameFate::other_input;
  if (target.of_baseline && !usable)
    throw Error(fmt::format("{}: was{} is not in it, {} frame {} {}", baseline.file.string(),
                            target.plane, same->recording, frame.index,
                            same->baseline ? "is of another input there" : "is not there"));
  if (!usable) return;
  if (target.of_baseline) expect_plane(*same->baseline, target, baseline.file);
  place.baseline = *same->baseline;
  const auto id = target.of_baseline ? &PlaneComparison::baseline : &PlaneComparison::now;
  const auto fate = std::ranges::find(same->planes, target.plane, id);
  if (target.plane > 0 && fate != same->planes.end()) place.fate = *fate;
}

}  // namespace

bool is_report(const std::string& where) {
  std::ifstream file(where.substr(0, where.rfind('#')), std::ios::binary);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains("schema") || !json["schema"].is_string()) return false;
  return json["schema"].get<std::string>().starts_with("planescope.report/");
}

void open_report(State& state, const ReportLink& link) {
  const ReportTarget target = parse_report_target(link.target);
  const RecordedReport report = read_report(target.file);
  const RecordedRecording& recording = recording_of(report, target);
  const RecordedFrame& frame = frame_of(recording, target);
  if (target.plane > 0 && !target.of_baseline) expect_plane(frame, target, target.file);

  auto place = std::make_shared<ReportPlace>();
  place->frame = frame.index;
  place->plane = target.plane;
  place->of_baseline = target.of_baseline;
  place->now = frame;
  const auto baseline = baseline_of(report, link, target, place->note);
  if (baseline) find_fate(*baseline, report, frame, target, *place);
  PipelineOptions options = options_from(report, target.file, place->note);
  options.threads = state.document.options.threads;
  if (baseline) {
    try {
      place->options_a = options_from(baseline->report, baseline->file, place->note);
      place->options_a->threads = options.threads;
    } catch (const Error& error) {
      add_note(place->note, fmt::format("no A: {}", error.what()));
    }
  }
  if (place->options_a && same_options(*place->options_a, options) &&
      baseline->report.weights_sha256 == report.weights_sha256)
    add_note(place->note, "A and B are the same: the baseline had these options");
  OpenRecording open = open_recorded(state, recording, frame, link, target.file);

  take_recording(state, std::move(open), frame.index);
  state.document.options = options;
  state.document.marked.clear();
  ViewState& view = state.view;
  view.flash = view.marking = false;
  view.playing.direction = 0;
  view.camera.reset();
  view.arrival.reset();
  view.report_place = place;
  view.against = place->options_a ? Against::pinned : Against::nothing;
  if (place->options_a) view.tool_tab = "compare";
  if (target.plane > 0) view.inspector_tab = target.of_baseline ? "point" : "inspector";
}

}  // namespace planescope::desktop
