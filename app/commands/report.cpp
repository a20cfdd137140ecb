// planescope report: the command with its subcommands, from opening inputs to the final exit code.

#include "app/commands/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <utility>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_data.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/report_json.hpp"
#include "core/world/map_recording.hpp"
#include "render/palette.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRulesFile = "planescope.rules.json";

void print_facts(const fs::path& out, const report::Report& report, bool json) {
  const report::ReportTotals totals = report::totals_of(report);
  const std::string page = (out / "index.html").string();
  if (!json) {
    fmt::print("{}: {}, {}", page, counted(totals.frames_done, "frame"),
               counted(totals.planes, "plane"));
    const auto kept = static_cast<double>(totals.points);
    const auto beyond = static_cast<double>(totals.points_beyond_range);
    if (beyond > kept)  // most points are beyond the range
      fmt::print(", {:.0f} % of the points beyond the range (--max-range)",
                 100 * beyond / (kept + beyond));
    fmt::print("\n{}", report.judgement ? report.judgement->text() : "");
    return;
  }
  nlohmann::ordered_json facts = {
      {"schema", "planescope/report-written/1"}, {"page", page},
      {"recordings", totals.recordings},         {"frames_done", totals.frames_done},
      {"frames_refused", totals.frames_refused}, {"planes", totals.planes},
      {"rendered", !report.renderer.empty()}};
  if (report.judgement) facts["verdict"] = report::judgement_json(*report.judgement);
  fmt::print("{}", json_text(facts, 2));
}

/// Reads the baseline and rules. Throws Error.
report::ReportGuard open_guard(const ReportGuardArgs& args) {
  if (args.approve && args.baseline.empty())
    throw Error("--approve needs --baseline FILE, the file to write");
  if (args.approve) check_output_dir(fs::absolute(args.baseline).parent_path());
  if (args.approve && fs::is_directory(args.baseline))
    throw Error("--baseline " + args.baseline.string() + ": is a folder; expected a report.json");
  return {args.baseline, args.rules, args.approve};
}

/// Throws Error if the report would overwrite its baseline without approval.
void check_baseline_place(const ReportGuardArgs& args, const std::filesystem::path& out) {
  if (args.baseline.empty() || args.approve) return;
  if (std::filesystem::weakly_canonical(args.baseline) ==
      std::filesystem::weakly_canonical(out / "report.json"))
    throw Error("--baseline " + args.baseline.string() +
                ": the report would overwrite it; keep the baseline elsewhere");
}

/// Prints one line for each refused frame: damaged frames first, then frames that the baseline
/// processed. Frames that the baseline refused for the same reason are only counted.
void print_refusals(const report::Report& report) {
  std::vector<std::string> damaged, refused;
  int known = 0;
  const bool several = report.recordings.size() > 1;
  for (const report::ReportRecording& recording : report.recordings)
    for (const report::ReportFrame& frame : recording.frames) {
      if (frame.refused.empty()) continue;
      if (report::is_known_refusal(report, frame)) {
        ++known;
        continue;
      }
      (frame.unreadable ? damaged : refused)
          .push_back(fmt::format("{}{}: {}", several ? recording.name + " " : "",
                                 report::frame_text(frame.index, frame.name), frame.refused));
    }
  constexpr std::size_t kMostLines = 10;
  for (const auto& [level, lines] : {std::pair("error", &damaged), {"warning", &refused}}) {
    for (const std::string& line : *lines | std::views::take(kMostLines))
      notice("{}: {}", level, line);
    if (lines->size() > kMostLines)
      notice("{}: {} more frames are {}", level, lines->size() - kMostLines,
             lines == &damaged ? "damaged" : "rejected");
  }
  if (known > 0)
    notice("{} rejected, as in the baseline",
           known == 1 ? "1 frame is" : counted(known, "frame") + " are");
}

/// Adds a warning to each recording without planes in any frame.
void add_no_planes(report::Report& report) {
  for (report::ReportRecording& recording : report.recordings) {
    std::size_t done = 0, planes = 0, points = 0;
    for (const report::ReportFrame& frame : recording.frames) {
      done += frame.refused.empty();
      planes += frame.planes.size();
      points += frame.counts.kept;
    }
    if (done == 0 || planes > 0 || points == 0) continue;
    recording.info.warnings.push_back(no_planes_text(recording.name, done));
    notice("warning: {}", recording.info.warnings.back());
  }
}

/// Checks `report` against the guard, writes its files to `out`, which contains its frames, and
/// prints a summary. Returns the exit code like run_report(); throws Cancelled if the report is
/// partial.
int finish_report(const std::filesystem::path& out,
                  report::Report& report,
                  report::ReportGuard& guard,
                  const ReportGuardArgs& args,
                  bool json) {
  if (!report.partial && report.shard.empty()) add_no_planes(report);
  if (!report.partial) report.judgement = guard.judge(report);
  report::write_report_files(out, report);
  if (report.partial) throw Cancelled();
  print_facts(out, report, json);
  const report::ReportTotals totals = report::totals_of(report);
  print_refusals(report);
  if (!report.renderer_error.empty())
    notice("rendering failed, but the data files were written: {}", report.renderer_error);
  if (args.approve && totals.unreadable)
    notice("warning: --approve: {} is unchanged, because a frame is damaged",
           args.baseline.string());
  else if (args.approve) {
    fs::create_directories(fs::absolute(args.baseline).parent_path());
    guard.approve(out / "report.json", args.approve_only);
    notice("{} is now the baseline", args.baseline.string());
  }
  if (totals.unreadable) return 2;
  if (report.judgement && report.judgement->errors() > 0 && !args.approve) return 1;
  return report.renderer_error.empty() ? 0 : 3;
}

/// Writes the built-in rules to planescope.rules.json in the current folder. Throws Error if the
/// file exists.
int run_report_init(const fs::path& set) {
  if (std::filesystem::exists(kRulesFile))
    throw Error(std::string(kRulesFile) + ": already exists");
  const auto rules = report::built_in_rules(set.empty() ? "default" : set.string());
  if (rules.empty())
    throw Error("--rules: unknown set '" + set.string() +
                "'; expected strict, default, or lenient");
  write_file_text(kRulesFile, report::rules_json(rules));
  fmt::print("{}\n", kRulesFile);
  return 0;
}

std::string now_utc() {
  const auto now =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now.time_since_epoch().count()));
}

/// Reports of many frames get smaller copies, so that a browser can still open the page.
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
    recording.info.warnings = input.warnings;
    recording.name = names[i];
    if (fs::is_regular_file(input.path)) recording.sha256 = sha256_hex_of_file(input.path);
    recording.frame_count = input.recording->frame_count();
    recording.frames_asked = static_cast<int>(input.frames.size());
    report.recordings.push_back(std::move(recording));
  }
  return report;
}

/// Key of everything that a frame's results depend on, except the frame itself.
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

/// Tracks the planes of a recording and adds each frame's tracking metrics to the report.
void follow_planes(const OpenInput& input,
                   const planes::PipelineOptions& options,
                   const planes::Classifier* classifier,
                   std::stop_token stop,
                   report::ReportRecording& recording) {
  world::MapJob job;
  job.recording = input.recording.get();
  job.frames = input.frames;
  job.pipeline = options;
  job.classifier = classifier;
  job.threads = options.threads;
  job.stop = std::move(stop);
  job.progress = StageBar("tracks of " + recording.name);
  job.alone = true;
  const world::WorldMap map = world::map_recording(job);
  for (const world::FrameStability& s : world::stability_by_frame(map.tracker, map.poses.poses)) {
    const auto frame = std::ranges::find(recording.frames, s.frame, &report::ReportFrame::index);
    if (frame == recording.frames.end() || !frame->refused.empty()) continue;
    frame->tracks = {s.breaks, s.swaps, 100 * s.kept_share(), s.normal_jitter_deg(),
                     s.offset_jitter_m()};
  }
}

}  // namespace

int run_report(const ReportArgs& args, std::stop_token stop, const FrameRunner& runner) {
  if (args.init) return run_report_init(args.guard.rules);
  if (args.tracks && args.shard.count > 1)
    throw Error(
        "report: --tracks needs all frames of a recording; it cannot be combined with --shard");
  if (args.tracks && args.input.pipeline.classifier == "truth")
    throw Error(
        "report: --tracks cannot be combined with --classifier truth, which supports only labeled "
        "frames");
  report::ReportGuard guard = open_guard(args.guard);
  if (guard.is_on() && args.shard.count > 1)
    throw Error(
        "--shard cannot be combined with --baseline or --rules; pass them to planescope report "
        "merge");
  check_baseline_place(args.guard, args.out);
  const std::vector<OpenInput> inputs = open_inputs(args.input, args.out);
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);
  report::Report report = start_report(args, inputs, chosen);
  std::size_t total = 0;
  for (const OpenInput& input : inputs) total += input.frames.size();
  if (args.guard.approve && !args.guard.approve_only) guard.check_merge(report);
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
  for (report::ReportRecording& recording : report.recordings) recording.frames_asked = 0;
  for (const ReportSlot& slot : slots) {
    if (slot.colors_only) continue;
    frames.insert(slot.folder);
    resumed += slot.found;
    report::ReportRecording& recording = report.recordings[slot.input];
    ++recording.frames_asked;
    report.partial |= !slot.done;
    if (slot.done) recording.frames.push_back(folder.read(slot.folder));
  }
  // A recording without results is bad input, not a report; a shard may be empty.
  if (const report::ReportTotals totals = report::totals_of(report);
      !report.partial && args.shard.count == 1 && totals.frames_done == 0) {
    folder.give_up();
    throw Error(totals.first_refusal);
  }
  for (std::size_t i = 0; args.tracks && !report.partial && i < inputs.size(); ++i) {
    report::ReportRecording& recording = report.recordings[i];
    if (recording.info.width == 0) continue;
    try {
      follow_planes(inputs[i], args.input.pipeline, chosen.classifier.get(), stop, recording);
    } catch (const Error& error) {
      recording.info.warnings.push_back(std::string("planes are not tracked: ") + error.what());
      notice("warning: {}: {}", recording.name, recording.info.warnings.back());
    }
  }
  folder.commit(!report.partial, frames);
  if (args.resume) notice("{} of {} frames were already finished", resumed, frames.size());
  const int code = finish_report(args.out, report, guard, args.guard, args.json);
  const bool has_warning = std::ranges::any_of(
      report.recordings, [](const auto& recording) { return !recording.info.warnings.empty(); });
  return code == 0 && has_warning && args.input.warnings_as_errors ? 2 : code;
}

namespace {

struct ReportMergeArgs {
  std::vector<std::filesystem::path> shards;  // report folders written with --shard
  std::filesystem::path out;
  bool json = false;
  ReportGuardArgs guard;
};

struct ShardReport {
  fs::path dir;
  report::ReportHead head;
  Shard shard;
};

ShardReport read_shard(const fs::path& dir) {
  const fs::path file = dir / "report.json";
  ShardReport read{dir, report::read_report_head(file), {}};
  const report::Report& report = read.head.report;
  if (report.shard.empty()) throw Error(file.string() + ": is a complete report; expected a shard");
  if (report.partial)
    throw Error(file.string() + ": shard " + report.shard +
                " is incomplete; finish it with --resume");
  read.shard = parse_shard(report.shard);
  return read;
}

/// The part of report.json that all shards of a report share.
std::string common_text(const report::Report& report) {
  report::Report common = report;
  common.created_utc.clear();
  common.shard.clear();
  common.renderer.clear();
  common.renderer_error.clear();
  for (report::ReportRecording& recording : common.recordings) recording.frames_asked = 0;
  return report::report_json(common);
}

std::vector<ShardReport> read_shards(const std::vector<fs::path>& dirs) {
  std::vector<ShardReport> shards;
  for (const fs::path& dir : dirs) shards.push_back(read_shard(dir));
  std::ranges::stable_sort(shards, {}, [](const ShardReport& s) { return s.shard.index; });
  const ShardReport& first = shards.front();
  const std::string common = common_text(first.head.report);
  int expected = 1;
  for (const ShardReport& shard : shards) {
    const std::string name = shard.dir.string() + ": shard " + shard.head.report.shard;
    if (shard.shard.count != first.shard.count || common_text(shard.head.report) != common)
      throw Error(name + " belongs to a different report than " + first.dir.string() +
                  ": their recordings, options, weights, or builds differ");
    if (shard.shard.index < expected) throw Error(name + " appears twice");
    if (shard.shard.index > expected) break;
    ++expected;
  }
  if (expected <= first.shard.count)
    throw Error(fmt::format("shard {}/{} is missing", expected, first.shard.count));
  return shards;
}

fs::path folder_of(const report::Report& report, std::size_t recording, int index) {
  return report_frame_folder(report.recordings.size(), recording, report.recordings[recording].name,
                             index);
}

/// Merges the shards of a report into the report that a run without --shard would have written,
/// except for times. Returns like run_report(). Throws Error if a shard is missing, given twice or
/// belongs to another report.
int run_report_merge(const ReportMergeArgs& args, std::stop_token) {
  report::ReportGuard guard = open_guard(args.guard);
  check_baseline_place(args.guard, args.out);
  std::vector<ShardReport> shards = read_shards(args.shards);
  for (const ShardReport& shard : shards)
    if (fs::weakly_canonical(shard.dir) == fs::weakly_canonical(args.out))
      throw Error("output " + args.out.string() + " is one of the shards");
  ReportFolder folder(args.out, false);
  folder.give_up();  // a failed merge starts over
  std::set<fs::path> frames;
  report::Report report = shards.front().head.report;
  report.shard.clear();
  for (report::ReportRecording& recording : report.recordings) recording.frames_asked = 0;
  for (const ShardReport& shard : shards) {
    const report::Report& part = shard.head.report;
    report.created_utc = std::max(report.created_utc, part.created_utc);
    if (report.renderer_error.empty()) report.renderer_error = part.renderer_error;
    for (std::size_t r = 0; r < report.recordings.size(); ++r)
      report.recordings[r].frames_asked += part.recordings[r].frames_asked;
    for (const auto& [recording, index] : shard.head.frames) {
      const fs::path frame = folder_of(report, recording, index);
      folder.take(frame, shard.dir);
      frames.insert(frame);
      report.recordings[recording].frames.push_back(folder.read(frame));
    }
  }
  if (!report.renderer_error.empty()) report.renderer.clear();
  if (const report::ReportTotals totals = report::totals_of(report); totals.frames_done == 0)
    throw Error(totals.first_refusal);
  folder.commit(true, frames);
  return finish_report(args.out, report, guard, args.guard, args.json);
}

void add_guard(CLI::App* command, ReportGuardArgs& guard) {
  add(command, "--baseline", guard.baseline, "FILE",
      "Earlier report.json to compare with; exit code 1 if planes got worse");
  add(command, "--rules", guard.rules, "SET|FILE",
      "Pass criteria: strict, default, lenient, or a planescope.rules.json (default with a "
      "baseline: default)");
  command->add_flag("--approve", guard.approve,
                    "Update the baseline with this report, keeping its other recordings");
  command->add_flag_callback(
      "--approve-only", [&guard] { guard.approve = guard.approve_only = true; },
      "Replace the whole baseline with this report");
}

void define_merge(CLI::App* report, Line& line) {
  CLI::App* merge = report->add_subcommand(
      "merge",
      "Join the shards of a report\nThe result equals the report of a run without --shard.");
  const auto args = std::make_shared<ReportMergeArgs>();
  merge->add_option("SHARD", args->shards, "Folders of all shards")->type_name("");
  add_out(merge, args->out);
  add_json(merge, args->json);
  add_guard(merge, args->guard);
  runs(merge, line, args, run_report_merge, [args, report] {
    for (const CLI::Option* option : report->get_options())
      if (option->count() > 0)
        throw Error("report merge: specify " + option->get_name() + " after merge, not before");
    if (args->out.empty()) throw Error("report merge needs -o DIR, the output folder");
    if (args->shards.empty()) throw Error("report merge needs the folders of the shards");
  });
}

}  // namespace

void define_report(CLI::App& app, Line& line) {
  CLI::App* report = app.add_subcommand(
      "report", "Write a report for the browser: index.html, report.json, pictures");
  const auto args = std::make_shared<ReportArgs>();
  add_recordings(report, args->input, true);
  add_out(report, args->out);
  add_json(report, args->json);
  add_method(report, args->input.pipeline);
  add_foot(report, args->input.pipeline);
  add_guard(report, args->guard);
  add_read(
      report, "--shard", [args](const std::string& text) { args->shard = parse_shard(text); },
      "I/N", "Process part I of N of the frames; planescope report merge joins the parts");
  report->add_flag("--tracks", args->tracks,
                   "Also track planes from frame to frame: lost planes, jitter");
  report->add_flag_callback(
      "--no-pictures", [args] { args->pictures = false; },
      "Skip pictures; about ten times faster, for checks before each commit");
  report->add_flag("--resume", args->resume, "Resume an interrupted run; finished frames are kept");
  report->add_flag("--init", args->init,
                   "Only write the default rules, or those of --rules SET, to "
                   "planescope.rules.json for editing");
  define_merge(report, line);
  const auto run = [](const ReportArgs& all, std::stop_token stop) {
    return run_report(all, stop);
  };
  runs(report, line, args, run, [&line, report, args] {
    args->command = line.frames_text;
    if (!args->init && args->out.empty()) throw Error("report needs -o DIR, the output folder");
    for (const CLI::Option* option : report->get_options())
      if (args->init && option->count() > 0 && option->get_name() != "--init" &&
          option->get_name() != "--rules")
        throw Error("report --init writes only planescope.rules.json; remove " +
                    option->get_name());
  });
}

}  // namespace planescope::app
