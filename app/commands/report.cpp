#include "app/commands/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "app/commands/report_finish.hpp"
#include "app/commands/report_pictures.hpp"
#include "core/model/error.hpp"
#include "core/model/sha256.hpp"
#include "core/report/data/build_info.hpp"
#include "render/palette.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

std::string now_utc() {
  const auto now =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now.time_since_epoch().count()));
}

/// Smaller copies in the page of a long recording, so that a browser still opens it.
int copy_width(std::size_t frames) { return frames <= 8 ? 1280 : frames <= 24 ? 800 : 560; }

report::Report start_report(const ReportArgs& args,
                            const std::vector<OpenInput>& inputs,
                            const planes::ChosenClassifier& chosen) {
  report::Report report;
  const report::BuildInfo build = report::build_info();
  report.version = build.version;
  report.commit = build.commit;
  report.modified = build.modified;
  report.command = args.command;
  if (args.shard.count > 1) report.shard = fmt::format("{}/{}", args.shard.index, args.shard.count);
  report.created_utc = now_utc();
  report.method = planes::to_string(args.input.pipeline.method);
  if (labels_points(args.input.pipeline)) report.classifier = args.input.pipeline.classifier;
  report.weights = chosen.weights;
  report.options = report::make_report_options(args.input.pipeline);
  for (const planes::Case c :
       {planes::Case::I, planes::Case::II, planes::Case::III, planes::Case::IV})
    report.case_colors[static_cast<int>(c)] = css_color(render::case_color(c));
  const std::vector<std::string> names = recording_names(inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const OpenInput& input = inputs[i];
    report::ReportRecording recording;
    recording.info = input.recording->info();
    recording.info.path = input.path;
    recording.name = names[i];
    if (fs::is_regular_file(input.path)) recording.sha256 = sha256_hex_of_file(input.path);
    recording.frame_count = input.recording->frame_count();
    report.recordings.push_back(std::move(recording));
  }
  return report;
}

/// All that a frame's results depend on but the frame.
std::string build_key(const report::Report& report, int copies) {
  std::string key =
      fmt::format("{}\n{}\n{}\n{}\n", report.version, report.commit, report.method, copies);
  if (report.modified || report.commit == "unknown")
    key += sha256_hex_of_file("/proc/self/exe") + "\n";
  if (report.weights) key += report.weights->sha256 + "\n";
  for (const report::ReportOption& option : report.options)
    key += option.name + "=" + option.value + "\n";
  return key;
}

}  // namespace

int run_report(const ReportArgs& args, std::stop_token stop, const FrameRunner& runner) {
  report::ReportGuard guard = open_guard(args.guard);
  if (guard.is_on() && args.shard.count > 1)
    throw Error("--shard: give --baseline and --rules to planescope report merge");
  InputArgs input_args = args.input;
  input_args.recording.damaged_frames_later = true;
  check_baseline_place(args.guard, args.out);
  const std::vector<OpenInput> inputs = open_inputs(input_args);
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);
  report::Report report = start_report(args, inputs, chosen);
  std::size_t total = 0;
  for (const OpenInput& input : inputs) total += input.frames.size();
  std::vector<ReportSlot> slots = report_slots(inputs, args.shard);

  ReportFolder folder(args.out, args.resume);
  const int copies = args.pictures ? copy_width(total) : 0;
  const ReportFramesJob job{inputs,
                            args.input.pipeline,
                            chosen.classifier.get(),
                            runner,
                            build_key(report, copies),
                            copies,
                            args.resume,
                            args.pictures};
  const ReportDrawing drawing = write_report_frames(job, folder, slots, stop);
  report.renderer = drawing.error.empty() ? drawing.renderer : "";
  report.renderer_error = drawing.error;
  std::set<fs::path> frames;
  int resumed = 0;
  for (const ReportSlot& slot : slots) {
    if (slot.colors_only) continue;
    frames.insert(slot.folder);
    resumed += slot.found;
    report::ReportRecording& recording = report.recordings[slot.input];
    ++recording.frames_asked;
    report.partial |= !slot.done;
    if (slot.done) recording.frames.push_back(folder.read(slot.folder));
  }
  // A recording that gives nothing at all is bad input, not a report; a shard may be so.
  if (!report.partial && args.shard.count == 1 && report::totals_of(report).frames_done == 0) {
    folder.give_up();
    throw_first_refusal(report);
  }
  folder.commit(!report.partial, frames);
  if (args.resume)
    fmt::print(stderr, "planescope: {} of {} frames were finished before\n", resumed,
               frames.size());
  return finish_report(args.out, report, guard, args.guard, args.json);
}

}  // namespace planescope::app
