// planescope-lab bench paper: the paper's tables and timings, on synthetic sets and real
// recordings.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/inputs.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/classifier_bench.hpp"
#include "core/lab/experiments/measure_paper.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/parallel.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kPaperParts = {"tables", "timings"};

/// A real recording and its name in the tables.
struct PaperRecording {
  std::string name;
  InputArgs input;
};

struct BenchPaperArgs {
  InputArgs input;                         // recordings as typed
  std::vector<PaperRecording> recordings;  // the selected recordings
  std::filesystem::path data;              // folder of recordings with labels
  std::string weights = "gcn";             // gcn (the shipped weights) or a file
  std::set<std::string> parts;             // of kPaperParts
  std::uint64_t seed = 1, tuning_seed = 1001;
  std::vector<std::string> sets;  // sets to measure; empty: all
  int count = 0;                  // maximum frames per set; 0: all
  bool quick = false;             // fewer frames and conditions
  bool resume = false;
  int threads = all_cores();
  std::filesystem::path out;  // -o
  std::string same_command;   // reproduces the results; without folder names
};

// ---- Measured cells ----

/// DIR/cells.jsonl: a line that identifies the run, then one line per cell, so that an interrupted
/// run can be resumed.
class CellLog {
 public:
  /// Throws Error if the file exists and `resume` is not set, or if it belongs to another run: one
  /// whose seeds, weights, build or size differ from `run`, the first line of the results.
  CellLog(const fs::path& dir, const std::string& run, bool resume) : file_(dir / "cells.jsonl") {
    const Json identity = identity_of(Json::parse(run));
    std::string text = identity.dump() + "\n";
    if (fs::exists(file_)) {
      if (!resume)
        throw Error(
            dir.string() +
            ": contains an unfinished run; continue it with --resume, or use a different -o");
      std::ifstream in = open_to_read(file_);
      int number = 0;
      // Drop an incomplete last line.
      for (std::string line; std::getline(in, line) && !in.eof();) {
        const std::string where = fmt::format("{}, line {}", file_.string(), ++number);
        const Json json = parse_json<Json>(line, where);
        if (number == 1) {
          check_same_run(json, identity);
          continue;
        }
        if (!json.is_object() || !json.contains("key"))
          throw Error(where + ": not a cell; expected an object with a key");
        lines_[json["key"].dump()] = line + '\n';
        text += line + '\n';
      }
    }
    write_file_text(file_, text, Durable::yes);
  }

  bool has(const lab::CellKey& key) const { return lines_.contains(json_of(key).dump()); }
  const std::string& line(const lab::CellKey& key) const { return lines_.at(json_of(key).dump()); }
  void append(std::span<const lab::Cell> cells) {
    std::ofstream file(file_, std::ios::app | std::ios::binary);
    for (const lab::Cell& cell : cells) {
      const Json key = json_of(cell.key);
      file << (lines_[key.dump()] = lab::result_line(
                   "cell",
                   lab::with_metrics({{"key", key}, {"frames", cell.frames}}, cell.metrics)));
    }
    file.flush();
    if (!file) throw Error(file_.string() + ": could not be written completely (disk full?)");
  }
  /// Deletes the file once the results are written elsewhere.
  void remove() {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }

 private:
  /// Fields that must agree for cells to belong to the same run.
  static Json identity_of(const Json& run) {
    Json identity;
    for (const char* name :
         {"seed", "tuning_seed", "quick", "count", "version", "commit", "modified"})
      identity[name] = run.at(name);
    identity["weights"] = run.at("weights").at("sha256");
    return identity;
  }
  void check_same_run(const Json& found, const Json& expected) const {
    for (const auto& [name, value] : expected.items())
      if (const Json other = found.is_object() ? found.value(name, Json()) : Json(); other != value)
        throw Error(fmt::format(
            "{}: belongs to a run with {} {}; expected {}; use a different -o, or delete the file",
            file_.string(), name, other.dump(), value.dump()));
  }

  fs::path file_;
  std::map<std::string, std::string> lines_;  // by key
};

// ---- Real recordings ----

struct RealInput {
  std::string name;
  OpenInput input;
  planes::PipelineOptions options;  // for one thread
};

/// Opens all recordings and selects at most `frames` of each, evenly spaced.
std::vector<RealInput> open_real(std::span<const PaperRecording> recordings, int frames) {
  std::vector<RealInput> opened;
  for (const PaperRecording& recording : recordings) {
    RealInput& real = opened.emplace_back(RealInput{
        recording.name, std::move(open_inputs(recording.input)[0]), recording.input.pipeline});
    real.options.threads = 1;
    real.input.frames = spread(real.input.frames, frames);
  }
  return opened;
}

/// Mean sizes over the frames, as in Table IV of the paper. Independent of the number of threads.
Json sizes_of(const RealInput& real,
              const planes::Classifier& classifier,
              int threads,
              const std::function<void(int, int)>& progress) {
  struct Sizes {
    double n_m = 0, n_d = 0, planes = 0;
  };
  std::vector<std::optional<Sizes>> of_frames(real.input.frames.size());
  const auto measure = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    try {
      const planes::FrameResult result =
          run_input_frame(real.input, real.input.frames[k], real.options, &classifier, false)
              .result;
      of_frames[k] = {static_cast<double>(result.cloud.counts.kept),
                      static_cast<double>(result.voxels.points.size()),
                      static_cast<double>(result.segmentation.planes.size())};
    } catch (const FrameRefused&) {
      // Counted below: gravity is unknown.
    }
  };
  work_through(static_cast<int>(of_frames.size()), threads, measure, progress);

  int frames = 0;
  Sizes sum;
  for (const std::optional<Sizes>& sizes : of_frames) {
    if (!sizes) continue;
    ++frames;
    sum.n_m += sizes->n_m;
    sum.n_d += sizes->n_d;
    sum.planes += sizes->planes;
  }
  const double divisor = std::max(1, frames);
  return {{"recording", real.name},
          {"frames", frames},
          {"refused", std::ssize(of_frames) - frames},
          {"n_m", sum.n_m / divisor},
          {"n_d", sum.n_d / divisor},
          {"planes", sum.planes / divisor}};
}

/// Times the frames with known gravity in `runs` runs.
Json times_of(const RealInput& real,
              const planes::Classifier& classifier,
              int threads,
              int runs,
              const std::function<void(int, int)>& progress) {
  planes::PipelineOptions options = real.options;
  std::vector<int> frames;
  for (const int frame : real.input.frames) {
    try {
      planes::resolve_gravity(real.input.recording->frame(frame), options.gravity);
      frames.push_back(frame);
    } catch (const Error&) {
      // Skipped; counted in the sizes for Table IV.
    }
  }
  options.threads = threads;
  lab::FrameRow row;
  if (!frames.empty())
    row = lab::measure_frames(*real.input.recording, frames, options, classifier, progress, runs);
  return {{"recording", real.name},  {"frames", frames.size()}, {"t_d_ms", row.ms.t_d_ms},
          {"t_c_ms", row.ms.t_c_ms}, {"t_b_ms", row.ms.t_b_ms}, {"t_s_ms", row.ms.t_s_ms},
          {"fps", row.fps}};
}

// ---- The run ----

class PaperRun {
 public:
  PaperRun(const BenchPaperArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)) {}

  int run() {
    check_output_dir(args_.out);
    // Detect damaged input before anything slow starts.
    load_classifiers();
    real_ = open_real(args_.recordings, args_.quick ? 3 : 30);
    make_output_dir(args_.out);
    if (wanted("tables")) measure_tables();
    if (wanted("timings")) measure_times();
    return 0;
  }

 private:
  bool wanted(const char* part) const { return args_.parts.contains(part); }
  void check_stop() const {
    if (stop_.stop_requested()) throw Cancelled();
  }

  void load_classifiers() {
    planes::PipelineOptions options;
    options.classifier = args_.weights;
    planes::ChosenClassifier chosen = choose_classifier(options);
    if (!chosen.weights)
      throw Error("--weights: '" + args_.weights +
                  "' is not a network; expected gcn or a weights file");
    weights_ = *chosen.weights;
    tools_.gcn = std::move(chosen.classifier);
    tools_.pca = planes::make_pca_classifier(options.pca);
    tools_.threads = args_.threads;
    if (wanted("tables")) tools_.real_labeled = lab::read_real_labeled(args_.data);
  }

  void measure_tables() {
    lab::ResultLines lines("paper", args_.same_command, weights_,
                           {{"seed", args_.seed},
                            {"tuning_seed", args_.tuning_seed},
                            {"quick", args_.quick},
                            {"count", args_.count}});
    CellLog log(args_.out, lines.text(), args_.resume);
    const lab::PaperPlan plan{args_.seed,  args_.tuning_seed, args_.sets,
                              args_.count, args_.quick,       tools_.real_labeled.has_value()};
    measure_all(plan, log);
    for (const RealInput& input : real_) {
      Progress bar(input.name, static_cast<int>(input.input.frames.size()));
      lines.add("real", sizes_of(input, *tools_.gcn, args_.threads, [&](int done, int) {
                  check_stop();
                  bar.show(done, "");
                }));
    }
    for (const lab::EvaluationSet& set : lab::evaluation_sets())
      lines.add("set", {{"set", set.name}, {"meaning", set.meaning}});
    for (const lab::CellKey& key : lab::planned_cells(plan)) lines.append(log.line(key));
    deliver(lines, args_.out, "paper");
    log.remove();
  }

  /// Measures every planned cell that is not in the log, one frame set after another.
  void measure_all(const lab::PaperPlan& plan, CellLog& log) {
    std::vector<lab::CellKey> left = lab::planned_cells(plan);
    const auto all = static_cast<int>(left.size());
    std::erase_if(left, [&](const lab::CellKey& key) { return log.has(key); });
    Progress bar("cells", all);
    while (!left.empty()) {
      const lab::CellKey first = left[0];
      const auto rest = std::stable_partition(
          left.begin(), left.end(),
          [&](const lab::CellKey& key) { return !lab::same_frames(key, first); });
      const std::vector<lab::CellKey> group(rest, left.end());
      left.erase(rest, left.end());
      const int before = all - static_cast<int>(left.size() + group.size());
      const std::string name = lab::frames_name(first);
      log.append(lab::measure_cells(
          group, lab::planned_frames(plan, first.set), tools_, [&](int done, int frames) {
            check_stop();
            bar.show(before, fmt::format("{}, frame {}/{}", name, done, frames));
          }));
      check_stop();
    }
  }

  void measure_times() {
    lab::ResultLines lines(
        "paper.timings", args_.same_command, weights_,
        {{"machine", lab::machine_json(lab::this_machine())}, {"threads", args_.threads}});
    lab::TimingOptions options;
    options.seed = args_.seed;
    options.threads = args_.threads;
    options.rounds = std::min(args_.count > 0 ? args_.count : 20, args_.quick ? 5 : 20);
    options.before_turn = [this] { check_stop(); };
    {
      const auto real = static_cast<int>(real_.size());
      Progress bar("timings", 2 + real);
      bar.show(0, "classifiers");
      lab::time_classifiers(tools_, options, lines);
      bar.show(1, "methods");
      lab::time_methods(tools_, options, lines);
      for (int i = 0; i < real; ++i) {
        bar.show(2 + i, real_[i].name);
        lines.add("real_time", times_of(real_[i], *tools_.gcn, args_.threads, args_.quick ? 5 : 30,
                                        [&](int, int) { check_stop(); }));
      }
    }
    deliver(lines, args_.out, "paper.timings");
  }

  const BenchPaperArgs& args_;
  std::stop_token stop_;
  lab::CellTools tools_;
  planes::WeightsRecord weights_;
  std::vector<RealInput> real_;
};

/// Runs the paper's experiments: results go to paper.jsonl, times to paper.timings.jsonl. Throws
/// Cancelled on stop; the run can then be resumed.
int run_bench_paper(const BenchPaperArgs& args, std::stop_token stop) {
  return PaperRun(args, std::move(stop)).run();
}

/// Reads a list like assets/paper_recordings.txt and returns the recordings that exist below
/// `data`. Throws Error with the list and line number if a line is invalid.
std::vector<PaperRecording> listed_recordings(const fs::path& list, const fs::path& data) {
  static const std::vector<std::string> options = {"--frames", "--gravity", "--intrinsics",
                                                   "--depth-unit"};
  std::vector<PaperRecording> recordings;
  read_list(list, [&](std::istringstream& words) {
    std::string name, path;
    if (!(words >> name >> path)) throw Error("name without a path; expected NAME PATH OPTIONS");
    PaperRecording recording{name, {}};
    set_listed_options(recording.input, words, options);
    recording.input.inputs = {data / path};
    recording.input.recording.color = false;
    if (fs::exists(data / path)) recordings.push_back(std::move(recording));
  });
  return recordings;
}

/// Returns the recordings on the command line, or those of the shipped list that exist below
/// $PLANESCOPE_DATA.
std::vector<PaperRecording> chosen_recordings(const BenchPaperArgs& args) {
  if (args.input.inputs.empty())
    return args.data.empty()
               ? std::vector<PaperRecording>()
               : listed_recordings(
                     find_asset("paper_recordings.txt", "the list of bench paper's recordings is"),
                     args.data);
  std::vector<PaperRecording> recordings;
  for (const fs::path& input : args.input.inputs) {
    recordings.push_back({fs::absolute(input / "").parent_path().filename().string(), args.input});
    recordings.back().input.inputs = {input};
  }
  return recordings;
}

/// The command without folders and threads, which do not affect the results.
std::string same_command(const BenchPaperArgs& args, const CLI::App& typed) {
  std::string text = "planescope-lab bench paper";
  for (const fs::path& input : args.input.inputs)
    text += fmt::format(" {}", input.lexically_normal().filename().string());
  text += fmt::format(" --seed {} --tuning-seed {}", args.seed, args.tuning_seed);
  if (args.quick) text += " --quick";
  return text + typed_text(typed, {"--sets", "--count", "--frames", "--gravity", "--intrinsics",
                                   "--depth-unit"});
}

void finish(BenchPaperArgs& args, const CLI::App& typed) {
  for (const std::string& set : args.sets)
    if (set != lab::kRealLabeled) lab::find_evaluation_set(set);
  if (args.parts.empty()) args.parts = {kPaperParts.begin(), kPaperParts.end()};
  args.input.pipeline.threads = args.threads;
  args.data = data_folder();
  args.recordings = chosen_recordings(args);
  for (const PaperRecording& recording : args.recordings)
    expect_gravity(recording.input.pipeline, "bench paper");
  args.same_command = same_command(args, typed);
}

}  // namespace

void define_bench_paper(CLI::App* bench, Line& line) {
  CLI::App* paper =
      bench->add_subcommand("paper",
                            "Run every experiment of the paper, with stricter measures\n"
                            "Writes paper.jsonl and paper.timings.jsonl.");
  const auto args = std::make_shared<BenchPaperArgs>();
  add_inputs(paper, args->input,
             "Recordings for table IV (default: those of assets/paper_recordings.txt that "
             "$PLANESCOPE_DATA contains)");
  paper->remove_option(paper->get_option("--labels"));
  add_of_method(paper, args->input.pipeline, "--gravity", "auto|X,Y,Z|imu|estimate",
                "Gravity direction of the given recordings")
      ->group("Recordings");
  add_out(paper, args->out)->required();
  paper->add_flag("--quick", args->quick,
                  "Use fewer frames and conditions; takes under two minutes");
  paper->add_flag("--resume", args->resume, "Resume the interrupted run in DIR");
  add_parts(paper, args->parts, kPaperParts,
            fmt::format("Parts to measure: {} (default: all)", fmt::join(kPaperParts, ", ")));
  add(paper, "--seed", args->seed, "N", "Random seed of the printed sets (default 1)")
      ->transform(whole(1));
  add(paper, "--tuning-seed", args->tuning_seed, "N",
      "Random seed of the sets that options were tuned on (default 1001)")
      ->transform(whole(1));
  add(paper, "--sets", args->sets, "NAME,...",
      "Sets to measure: stairs, kerbs, depth_boxes, ... (default: all)");
  add(paper, "--count", args->count, "N", "Maximum number of frames of each set (default all)")
      ->transform(whole(1));
  add(paper, "--weights", args->weights, "gcn|FILE",
      "Network: gcn, the built-in one (default), or a file");
  add_threads(paper, args->threads);
  runs(paper, line, args, run_bench_paper, [args, paper] { finish(*args, *paper); });
}

}  // namespace planescope::app
