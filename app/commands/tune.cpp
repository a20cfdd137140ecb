// planescope tune: searches for better method options on labeled frames.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/lab/tuning/tuning_answer.hpp"
#include "core/lab/tuning/tuning_trials.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

struct TuneArgs {
  InputArgs input;
  std::filesystem::path list;        // --list; empty: the recordings of `input`
  std::filesystem::path out;         // -o
  std::vector<std::string> options;  // --only; empty: all tunable options
  int hold_out = 2;                  // hold out every N-th labeled frame
  int trials = 1000;
  double time_s = 0;  // 0: no limit
  bool json = false;
};

struct TuneFrames {
  std::vector<lab::TuningFrame> tuning, held;
  int code = 0;  // 2: damaged frames were skipped
};

/// One line of --list: a recording with its options.
struct Listed {
  InputArgs input;
  std::optional<bool> held;  // empty: --hold-out assigns its frames
};

bool parse_held(const std::string& text) {
  if (text == "held-out") return true;
  if (text == "tuning") return false;
  throw Error("HALF: unknown value '" + text + "'; expected tuning, held-out, or -");
}

/// Parses lines of HALF RECORDING OPTIONS, which override the command line. Paths are relative to
/// the list.
std::vector<Listed> read_tune_list(const TuneArgs& args) {
  static const std::vector<std::string> options = {"--frames",   "--intrinsics",     "--depth-unit",
                                                   "--gravity",  "--instance-field", "--labels",
                                                   "--max-range"};
  if (!args.input.inputs.empty())
    throw Error("--list specifies the recordings; remove " + args.input.inputs[0].string());
  const fs::path folder = fs::absolute(args.list).parent_path();
  std::vector<Listed> all;
  read_list(args.list, [&](std::istringstream& words) {
    std::string half, recording;
    if (!(words >> half >> recording)) throw Error("expected HALF RECORDING OPTIONS");
    Listed listed{args.input, {}};
    if (half != "-") listed.held = parse_held(half);
    set_listed_options(listed.input, words, options);
    listed.input.inputs = {folder / recording};
    if (listed.input.label_dir) listed.input.label_dir = folder / *listed.input.label_dir;
    if (!all.empty() && all[0].held.has_value() != listed.held.has_value())
      throw Error(
          "some lines name a half and others use -; expected a half on all lines, or - on all "
          "lines");
    all.push_back(std::move(listed));
  });
  if (all.empty()) throw Error(args.list.string() + ": lists no recordings");
  return all;
}

std::string hash_of(const planes::SourceTruth& truth) {
  return sha256_hex(std::as_bytes(std::span(truth.values.instance))) +
         sha256_hex(std::as_bytes(std::span(truth.values.label)));
}

/// Reads every labeled frame. Throws Error if a half is empty or both halves contain the same
/// frame.
TuneFrames read_tune_frames(const TuneArgs& args, const std::stop_token& stop) {
  std::vector<Listed> all;
  if (args.list.empty())
    all.push_back({args.input, {}});
  else
    all = read_tune_list(args);
  TuneFrames frames;
  std::map<std::string, std::pair<std::string, bool>> halves;  // by data hash: name, held out
  int count = 0;
  for (Listed& listed : all) {
    listed.input.recording.color = false;
    for (const OpenInput& input : open_inputs(listed.input, args.out)) {
      const auto take = [&](int index) {
        if (!may_have_truth(input, index)) return;
        lab::TuningFrame frame;
        frame.frame = input.frame(index);
        const std::string hash = input.recording->frame_hash(index);
        auto truth = input.truth(frame.frame);
        if (!truth) return;
        frame.name = fmt::format("{} {}", input.path.filename().string(), index);
        frame.hash = hash + hash_of(*truth);
        frame.truth = std::move(*truth);
        frame.options = listed.input.pipeline;
        const bool held = listed.held.value_or(++count % args.hold_out == 0);
        // Compare data, so that a copy or another format of a recording is detected too.
        const auto [first, is_new] = halves.try_emplace(hash, frame.name, held);
        if (!is_new && first->second.second != held)
          throw Error(
              fmt::format("{}: has the same data as {} in the other half; expected different "
                          "frames in each half",
                          frame.name, first->second.first));
        (held ? frames.held : frames.tuning).push_back(std::move(frame));
      };
      const DamagedFrames damaged = for_each_frame("frames", input.frames, stop, take);
      frames.code = std::max(frames.code, damaged.report(input.frames.size()));
    }
  }
  if (frames.tuning.empty() || frames.held.empty())
    throw Error(
        fmt::format("tune: found {} to tune on and {} to hold out; expected at "
                    "least one of each; label frames with `planescope view`, or specify their "
                    "label folder with --labels DIR",
                    counted(frames.tuning.size(), "labeled frame"), frames.held.size()));
  return frames;
}

/// A journal can only be resumed if these match. Held-out frames do not count: the search never
/// uses them.
lab::TuningPurpose purpose_of(const std::vector<lab::TuningFrame>& frames,
                              const std::vector<std::string>& searched,
                              const planes::ChosenClassifier& chosen) {
  std::string hashes, options, names;
  for (const lab::TuningFrame& frame : frames) {
    hashes += frame.hash;
    for (const planes::OptionInfo& info : planes::option_table())
      options += info.name + "=" + info.get(frame.options) + "\n";
  }
  for (const std::string& name : searched) names += name + "\n";
  const report::BuildInfo build = report::build_info();
  return {{"frames or labels", sha256_hex(hashes)},
          {"options", sha256_hex(options)},
          {"weights", chosen.weights ? chosen.weights->sha256 : "none"},
          {"options that are searched", sha256_hex(names)},
          {"program", build.version + " " + build.commit}};
}

std::vector<std::string> searched_options(const TuneArgs& args) {
  std::vector<std::string> names;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const bool asked =
        args.options.empty() || std::ranges::find(args.options, info.name) != args.options.end();
    if (asked && lab::is_tunable(info)) names.push_back(info.name);
  }
  for (const std::string& name : args.options)
    if (!lab::is_tunable(planes::find_option(name)))
      throw Error(
          fmt::format("--only {}: not tunable; expected a method option that does not affect which "
                      "points are scored",
                      name));
  return names;
}

class TuneRun {
 public:
  TuneRun(const TuneArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)), searched_(searched_options(args)) {}

  int run() {
    check_output_dir(args_.out);
    TuneFrames frames = read_tune_frames(args_, stop_);
    planes::ChosenClassifier chosen = choose_classifier(args_.input.pipeline);
    make_output_dir(args_.out);
    const FolderLock lock = FolderLock::acquire(args_.out, "planescope tune");
    if (!lock.is_held())
      throw Error(args_.out.string() + (lock.is_held_by_other() ? ": is " : ": ") + lock.why_not());
    lab::TuningJournal journal(args_.out, purpose_of(frames.tuning, searched_, chosen));
    if (!journal.trials().empty() && !args_.json)
      notice("resuming after {}", counted(journal.trials().size(), "trial"));
    const lab::TuningSet tuning(std::move(frames.tuning), chosen.classifier);
    const lab::TuningSet held(std::move(frames.held), chosen.classifier);

    lab::TuningAnswer answer;
    answer.base = args_.input.pipeline;
    for (const lab::TuningFrame& frame : tuning.frames()) answer.frames.push_back(frame.name);
    for (const lab::TuningFrame& frame : held.frames()) answer.held.push_back(frame.name);
    answer.tuned = search(tuning, journal);
    score_held(held, answer);
    answer.trials = journal.trials().size();
    for (const lab::Trial& trial : journal.trials())
      if (const auto ms = journal.time_of(trial.setting))
        answer.priced.push_back({trial.setting, lab::mean_score(trial), *ms});
    write(answer);
    return frames.code;
  }

 private:
  lab::Tuned search(const lab::TuningSet& set, lab::TuningJournal& journal) {
    const auto begin = std::chrono::steady_clock::now();
    Progress bar("tune", args_.trials);
    double best = 0;
    const auto evaluate = [&](std::span<const lab::Setting> settings, bool may_end) {
      std::vector<lab::Setting> unknown;
      for (const lab::Setting& setting : settings)
        if (!journal.find(setting) && std::ranges::find(unknown, setting) == unknown.end())
          unknown.push_back(setting);
      const auto take = [&](const lab::TimedTrial& timed) {
        journal.add(timed.trial, timed.ms);
        best = std::max(best, lab::mean_score(timed.trial));
      };
      const auto progress = [&](int, int) {
        if (stop_.stop_requested()) throw Cancelled();
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
        if (may_end && args_.time_s > 0 && spent.count() > args_.time_s) throw lab::TuningSpent();
        bar.show(std::min(static_cast<int>(journal.trials().size()), args_.trials),
                 fmt::format("best PQ {:.2f}", best));
      };
      set.score(unknown, args_.input.pipeline.threads, take, progress);
      std::vector<lab::Trial> trials;
      for (const lab::Setting& setting : settings) trials.push_back(*journal.find(setting));
      return trials;
    };
    return lab::search_options({args_.input.pipeline, searched_, args_.trials, evaluate});
  }

  void score_held(const lab::TuningSet& held, lab::TuningAnswer& answer) {
    const std::vector<lab::Setting> both = {{}, answer.tuned.best.setting};
    std::vector<lab::TimedTrial> scored;
    held.score(
        both, args_.input.pipeline.threads,
        [&](const lab::TimedTrial& timed) { scored.push_back(timed); },
        [&](int, int) {
          if (stop_.stop_requested()) throw Cancelled();
        });
    answer.held_base = scored[0].trial;
    answer.base_ms = scored[0].ms;
    answer.held_tuned = scored[1].trial;
    answer.tuned_ms = scored[1].ms;
  }

  void write(const lab::TuningAnswer& answer) {
    const std::string json = lab::tuning_json(answer);
    write_file_text(args_.out / "profile.json", lab::tuned_profile(answer));
    write_file_text(args_.out / "tuning.json", json);
    write_file_text(args_.out / "index.html", lab::tuning_page(answer));
    if (!answer.priced.empty())
      write_file_text(args_.out / "pareto.svg", lab::pareto_picture(answer));
    if (args_.json) {
      fmt::print("{}", json);
      return;
    }
    const std::string profile = (args_.out / "profile.json").string();
    fmt::print("{}\nprofile: {}\npage: {}\n", lab::tuning_text(answer), profile,
               (args_.out / "index.html").string());
  }

  const TuneArgs& args_;
  std::stop_token stop_;
  std::vector<std::string> searched_;
};

/// Searches options on labeled frames and writes the result. Run again to resume after an
/// interrupt, --trials or --time. Returns the exit code; throws Cancelled if interrupted.
int run_tune(const TuneArgs& args, std::stop_token stop) {
  return TuneRun(args, std::move(stop)).run();
}

}  // namespace

void define_tune(CLI::App& app, Line& line) {
  CLI::App* tune = app.add_subcommand(
      "tune",
      "Search for better options on labeled frames\n"
      "Searches on one half of the frames and scores the result once on the other half. Writes "
      "profile.json, for --profile, and index.html. Run it again to resume an interrupted search.");
  const auto args = std::make_shared<TuneArgs>();
  add_recordings(tune, args->input, true);
  add_out(tune, args->out)->required();
  add_json(tune, args->json);
  add(tune, "--list", args->list, "FILE",
      "File with one line per recording: HALF RECORDING OPTIONS. HALF is tuning, held-out, or - to "
      "hold out frames according to --hold-out. Paths are relative to the file");
  add(tune, "--hold-out", args->hold_out, "N",
      "Hold out every N-th labeled frame from the search (default 2)")
      ->transform(whole(2));
  add(tune, "--trials", args->trials, "N", "Maximum number of trials (default 1000)")
      ->transform(whole(1));
  add(tune, "--time", args->time_s, "SECONDS", "Time limit of the search (default: none)")
      ->check(number(0));
  add(tune, "--only", args->options, "NAME,...",
      "Options to search (default: all options of the method, docs/tuning.md)");
  add_method(tune, args->input.pipeline);
  runs(tune, line, args, run_tune);
}

}  // namespace planescope::app
