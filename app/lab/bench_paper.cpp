#include "app/lab/bench_paper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/bench_paper_figures.hpp"
#include "app/lab/bench_paper_real.hpp"
#include "core/lab/experiments/measure_paper.hpp"
#include "core/lab/experiments/paper_markdown.hpp"
#include "core/lab/experiments/paper_page.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/results.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "render/context.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

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
      const auto rest = std::ranges::stable_partition(
          left, [&](const lab::CellKey& key) { return !lab::same_frames(key, first); });
      const std::vector<lab::CellKey> group(rest.begin(), rest.end());
      left.erase(rest.begin(), rest.end());
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
      fmt::print(stderr, "planescope: no figures: {}\n", error.what());
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
          nlohmann::ordered_json::parse(read_file_bytes(file));
    }
    fmt::print("{}\n", json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  const BenchPaperArgs& args_;
  std::stop_token stop_;
  lab::CellTools tools_;
  planes::WeightsRecord weights_;
  std::optional<lab::CellLog> log_;  // until all is done, so that --resume measures no cell again
};

}  // namespace

const std::vector<std::string>& bench_paper_parts() {
  static const std::vector<std::string> parts = {"tables", "timings", "figures"};
  return parts;
}

int run_bench_paper(const BenchPaperArgs& args, std::stop_token stop) {
  if (!args.doc.empty()) {
    write_file_text(args.doc, lab::reproduction_page(lab::read_results(args.from),
                                                     lab::read_timings(args.from)));
    return 0;
  }
  return PaperRun(args, std::move(stop)).run();
}

}  // namespace planescope::app
