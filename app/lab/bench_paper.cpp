#include "app/lab/bench_paper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "app/lab/lists.hpp"
#include "core/lab/experiments/measure_paper.hpp"
#include "core/lab/experiments/paper_markdown.hpp"
#include "core/lab/experiments/paper_page.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/results.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "render/renderer.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kPaperParts = {"tables", "timings", "figures"};

struct BenchPaperArgs {
  InputArgs input;                         // recordings as they are typed
  std::vector<PaperRecording> recordings;  // those that are taken
  std::filesystem::path data;              // folder of recordings that labels are taken from
  std::string weights = "gcn";             // gcn, the shipped ones, or a file
  std::set<std::string> parts;             // of kPaperParts
  std::uint64_t seed = 1, tuning_seed = 1001;
  std::vector<std::string> sets;  // that are measured; empty: all
  int count = 0;                  // frames of a set at most; 0: all
  bool quick = false;             // fewer frames and conditions
  bool resume = false;
  int threads = all_cores();
  std::filesystem::path out;   // -o
  std::filesystem::path from;  // results that are there: nothing is measured
  std::filesystem::path doc;   // with `from`: the file of docs/reproduction.md
  bool json = false;
  std::string same_command;  // measures the same again; without folders, which are this machine's
};

/// What was measured, now or before.
struct Measured {
  lab::PaperResults results;
  std::optional<lab::PaperTimings> timings;
};

/// Pages of what is there. Without figures the page has none.
void write_pages(const fs::path& dir,
                 const Measured& m,
                 const std::vector<lab::PaperFigure>& figures) {
  write_file_text(dir / "paper.md", lab::paper_markdown(m.results));
  if (m.timings)
    write_file_text(dir / "paper.timings.md",
                    joined(lab::timing_tables(*m.timings), lab::to_markdown));
  for (const lab::PaperFigure& figure : figures)
    for (const lab::PaperPicture& picture : figure.pictures)
      write_file_bytes(dir / picture.png, picture.bytes);
  write_file_text(dir / "index.html",
                  lab::paper_page(m.results, m.timings ? &*m.timings : nullptr, figures));
}

/// Throws Error where the folder holds anything that is not from an earlier run: a recording, say.
void check_own(const fs::path& dir) {
  if (!fs::exists(dir) || fs::is_empty(dir)) return;
  for (const char* own : {"cells.jsonl", "paper.json", "paper.timings.json", "paper.md"})
    if (fs::exists(dir / own)) return;
  throw Error("output " + dir.string() +
              ": holds other files, expected an empty folder or one of bench paper");
}

class PaperRun {
 public:
  PaperRun(const BenchPaperArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)) {}

  int run() {
    check_output_dir(args_.out);
    check_own(args_.out);
    Measured measured = args_.from.empty() ? measure() : recorded(args_.from);
    make_output_dir(args_.out);
    write_pages(args_.out, measured, {});
    const bool drawn = !wanted("figures") || !is_of_this_build(measured.results) || draw(measured);
    if (log_) log_->finish();
    tell(measured);
    return drawn ? 0 : 3;
  }

 private:
  bool wanted(const char* part) const { return args_.parts.contains(part); }
  void check_stop() const {
    if (stop_.stop_requested()) throw Cancelled();
  }

  /// Pictures of another build, or with other weights, would show what the tables do not say.
  bool is_of_this_build(const lab::PaperResults& results) const {
    const report::BuildInfo now = report::build_info();
    return results.build.commit == now.commit && results.build.modified == now.modified &&
           (weights_.sha256.empty() || results.weights.sha256 == weights_.sha256);
  }

  static Measured recorded(const fs::path& dir) {
    Measured measured{lab::read_results(dir), std::nullopt};
    if (fs::exists(dir / "paper.timings.json")) measured.timings = lab::read_timings(dir);
    return measured;
  }

  Measured measure() {
    // Damaged input is found before anything slow starts.
    load_classifiers();
    const std::vector<RealInput> real = open_real(args_.recordings, args_.quick ? 3 : 30);
    make_output_dir(args_.out);
    Measured measured;
    // What is not asked for stays as it was measured before.
    measured.results = start_results();
    if (!wanted("tables") && fs::exists(args_.out / "paper.json")) {
      measured.results = lab::read_results(args_.out);
      if (!is_of_this_build(measured.results))
        throw Error(
            fmt::format("{}: measured by commit {} with weights {}, this is commit {} with "
                        "weights {}; measure its tables as well, or give another -o",
                        (args_.out / "paper.json").string(), measured.results.build.commit,
                        measured.results.weights.file, report::build_info().commit, weights_.file));
    }
    if (!wanted("timings") && fs::exists(args_.out / "paper.timings.json"))
      measured.timings = lab::read_timings(args_.out);
    if (wanted("tables")) measure_tables(real, measured.results);
    if (wanted("timings")) measured.timings = measure_times(real);
    return measured;
  }

  void load_classifiers() {
    planes::PipelineOptions options;
    options.classifier = args_.weights;
    planes::ChosenClassifier chosen = choose_classifier(options);
    if (!chosen.weights)
      throw Error("--weights: '" + args_.weights +
                  "' is not a network, expected gcn or a weights file");
    weights_ = *chosen.weights;
    tools_.gcn = std::move(chosen.classifier);
    tools_.pca = planes::make_pca_classifier(options.pca);
    tools_.threads = args_.threads;
    if (wanted("tables")) tools_.real_labelled = lab::read_real_labelled(args_.data);
  }

  lab::PaperResults start_results() const {
    lab::PaperResults results;
    results.command = args_.same_command;
    results.build = report::build_info();
    results.weights = weights_;
    results.seed = args_.seed;
    results.tuning_seed = args_.tuning_seed;
    results.quick = args_.quick;
    results.count = args_.count;
    return results;
  }

  void measure_tables(const std::vector<RealInput>& real, lab::PaperResults& results) {
    log_.emplace(args_.out, results, args_.resume);
    measure_all(*log_);
    for (const RealInput& input : real) {
      Progress bar(input.name, static_cast<int>(input.input.frames.size()));
      results.real.push_back(measure_real(input, *tools_.gcn, args_.threads, [&](int done, int) {
        check_stop();
        bar.show(done, "");
      }));
    }
    for (const lab::CellKey& key : plan())
      results.cells.push_back(*std::ranges::find(log_->cells(), key, &lab::Cell::key));
    lab::write_results(args_.out, results);
  }

  std::vector<lab::CellKey> plan() const { return lab::planned_cells(paper_plan()); }
  lab::PaperPlan paper_plan() const {
    return {args_.seed,  args_.tuning_seed, args_.sets,
            args_.count, args_.quick,       tools_.real_labelled.has_value()};
  }

  /// Every planned cell that the log has not yet, frames by frames.
  void measure_all(lab::CellLog& log) {
    std::vector<lab::CellKey> left = plan();
    const auto all = static_cast<int>(left.size());
    std::erase_if(left, [&](const lab::CellKey& key) {
      return std::ranges::find(log.cells(), key, &lab::Cell::key) != log.cells().end();
    });
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
          group, lab::planned_frames(paper_plan(), first.set), tools_, [&](int done, int frames) {
            check_stop();
            bar.show(before, fmt::format("{}, frame {}/{}", name, done, frames));
          }));
      check_stop();
    }
  }

  lab::PaperTimings measure_times(const std::vector<RealInput>& real) {
    lab::PaperTimings timings;
    timings.command = args_.same_command;
    timings.machine = lab::this_machine();
    timings.threads = args_.threads;
    const auto counted = args_.count > 0 ? args_.count : 20;
    lab::TimingOptions options;
    options.seed = args_.seed;
    options.threads = args_.threads;
    options.rounds = std::min(counted, args_.quick ? 5 : 20);
    options.before_turn = [this] { check_stop(); };
    {
      Progress bar("timings", 2 + static_cast<int>(real.size()));
      bar.show(0, "classifiers");
      timings.classifiers = lab::classifier_timings(tools_, options);
      bar.show(1, "methods");
      timings.methods = lab::method_timings(tools_, options);
      for (const RealInput& input : real) {
        bar.show(2 + static_cast<int>(timings.real.size()), input.name);
        timings.real.push_back(time_real(input, *tools_.gcn, args_.threads, args_.quick ? 5 : 30,
                                         [&](int, int) { check_stop(); }));
      }
    }
    lab::write_timings(args_.out, timings);
    return timings;
  }

  /// False where nothing can be drawn here.
  bool draw(const Measured& measured) {
    std::unique_ptr<render::GlContext> context;
    std::unique_ptr<render::Renderer> renderer;
    try {
      context = render::make_egl_context();
      renderer = std::make_unique<render::Renderer>();
    } catch (const Error& error) {
      notice("no figures: {}", error.what());
      return false;
    }
    Progress bar("figures", 1);
    PaperFigureArgs figure_args;
    figure_args.recordings = args_.recordings;
    figure_args.weights = args_.weights;
    figure_args.threads = args_.threads;
    figure_args.stop = stop_;
    figure_args.progress = [&bar](const std::string& what) { bar.show(0, what); };
    write_pages(args_.out, measured, draw_paper_figures(figure_args, measured.results, *renderer));
    renderer.reset();  // before its context
    return true;
  }

  void tell(const Measured& m) const {
    if (args_.json) return tell_json();
    std::vector<lab::Table> tables;
    if (const std::vector<lab::Claim> all = lab::claims(m.results); !all.empty())
      tables.push_back(lab::claim_table(all));
    for (lab::Table& table : lab::paper_tables(m.results)) tables.push_back(std::move(table));
    if (m.timings)
      for (lab::Table& table : lab::timing_tables(*m.timings)) tables.push_back(std::move(table));
    fmt::print("{}\nAll tables and figures: {}\n", joined(tables, lab::to_text),
               (args_.out / "index.html").string());
  }

  void tell_json() const {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    const fs::path dir = args_.from.empty() ? args_.out : args_.from;
    for (const char* name : {"paper", "paper.timings"}) {
      const fs::path file = dir / (std::string(name) + ".json");
      if (!fs::exists(file)) continue;
      json[name == std::string("paper") ? "results" : "timings"] =
          read_json<nlohmann::ordered_json>(file);
    }
    fmt::print("{}\n", json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  const BenchPaperArgs& args_;
  std::stop_token stop_;
  lab::CellTools tools_;
  planes::WeightsRecord weights_;
  std::optional<lab::CellLog> log_;  // until all is done, so that --resume measures no cell again
};

/// The paper's experiments: paper.json, .md and index.html, and what depends on time in
/// paper.timings.json and .md. Returns the exit code, 3 where pictures could not be drawn; throws
/// Cancelled on stop, and what was measured can be gone on with.
int run_bench_paper(const BenchPaperArgs& args, std::stop_token stop) {
  if (!args.doc.empty()) {
    write_file_text(args.doc, lab::reproduction_page(lab::read_results(args.from),
                                                     lab::read_timings(args.from)));
    return 0;
  }
  return PaperRun(args, std::move(stop)).run();
}

/// What is typed, or those of the list that comes with planescope which are below $PLANESCOPE_DATA.
std::vector<PaperRecording> chosen_recordings(const BenchPaperArgs& args) {
  if (args.input.inputs.empty())
    return args.data.empty() || !args.from.empty()
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

/// Without folders and threads: both leave the results alone.
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
  if (args.doc.empty() && args.out.empty()) throw Error("bench paper needs -o DIR: Output folder");
  if (!args.doc.empty() && args.from.empty())
    throw Error("--doc needs the results that it is written from, --from DIR");
  for (const std::string& set : args.sets)
    if (set != lab::kRealLabelled) lab::find_evaluation_set(set);
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
  CLI::App* paper = bench->add_subcommand(
      "paper",
      "Every experiment of the paper beside its printed numbers, and measures on which methods\n"
      "really differ: tables, plots and pictures as one page.");
  const auto args = std::make_shared<BenchPaperArgs>();
  add_inputs(paper, args->input,
             "Recordings for table IV; without, those of assets/paper_recordings.txt that are\n"
             "below $PLANESCOPE_DATA");
  paper->remove_option(paper->get_option("--labels"));
  add_of_method(paper, args->input.pipeline, "--gravity", "auto|X,Y,Z|imu|estimate",
                "Of the recordings that are given")
      ->group("Recordings");
  add_out(paper, args->out);
  add_json(paper, args->json);
  paper->add_flag("--quick", args->quick, "Fewer frames and conditions: under two minutes");
  paper->add_flag("--resume", args->resume, "Go on with the run that was cut short in DIR");
  add_parts(paper, args->parts, kPaperParts,
            fmt::format("Of {}; the others stay as they are in DIR. Default: all",
                        fmt::join(kPaperParts, ", ")));
  add(paper, "--seed", args->seed, "N", "Of the sets that the tables are printed for, default 1")
      ->transform(whole(1));
  add(paper, "--tuning-seed", args->tuning_seed, "N",
      "Of the sets that options were tuned on, shown beside the claims; default 1001")
      ->transform(whole(1));
  add(paper, "--sets", args->sets, "NAME,...",
      "Measure these alone, of stairs, kerbs, depth_boxes, ...");
  add(paper, "--count", args->count, "N", "At most so many frames of each set; default all")
      ->transform(whole(1));
  add(paper, "--weights", args->weights, "gcn|FILE",
      "The network: gcn, the one that comes with planescope (default), or a file");
  add(paper, "--from", args->from, "DIR",
      "Measure nothing: write pages of the results there, with figures where\nthey are of this "
      "commit");
  add(paper, "--doc", args->doc, "FILE.md", "With --from: write docs/reproduction.md alone");
  add_threads(paper, args->threads);
  runs(paper, line, args, run_bench_paper, [args, paper] { finish(*args, *paper); });
}

}  // namespace planescope::app
