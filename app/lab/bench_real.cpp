#include "app/lab/bench_real.hpp"

#include <fmt/format.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/inputs.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/real_results.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

/// What is measured from frame to frame: a robot drives through a room, and its camera looks at
/// the floor.
constexpr const char* kRepeatRecording = "aims_slam_realsense_640x480";

lab::Reading repeat_reading() {
  lab::Reading reading;
  reading.recording.intrinsics = {383.8, 383.8, 321.7, 236.8};
  reading.gravity = {planes::GravityMode::fixed, Vec3d(0.168, 0.925, 0.341)};
  reading.max_range_m = 4;
  return reading;
}

class RealRun {
 public:
  RealRun(const BenchRealArgs& args, std::stop_token stop) : args_(args), stop_(std::move(stop)) {}

  int run() {
    check_output_dir(args_.out);
    // What is missing is told before anything slow starts.
    std::vector<lab::EvaluationFrame> frames;
    for (const lab::ListedFrame& listed : args_.frames)
      frames.push_back(lab::read_listed(listed, args_.data, args_.labels));
    std::unique_ptr<io::Recording> repeated;
    if (wanted("repeat"))
      repeated = io::open_recording(args_.data / kRepeatRecording, repeat_reading().recording);

    lab::RealResults results = start_results();
    if (wanted("frames"))
      results.labelled = lab::measure_labelled(args_.frames, frames, tools_, Bar("frames", stop_));
    if (wanted("sets")) results.sets = measure_sets();
    if (repeated) {
      results.repeat = lab::measure_repeat(*repeated, repeat_reading(), args_.count, tools_,
                                           Bar("repeat", stop_));
      results.repeat.recording = kRepeatRecording;
    }
    make_output_dir(args_.out);
    const std::string json = lab::real_json(results);
    write_file_text(args_.out / "real.json", json);
    write_file_text(args_.out / "real.md", lab::real_markdown(results));
    fmt::print("{}", args_.json ? json : joined(lab::real_tables(results), lab::to_text));
    return 0;
  }

 private:
  bool wanted(const char* part) const { return args_.parts.contains(part); }

  lab::RealResults start_results() {
    const planes::PipelineOptions options;
    planes::ChosenClassifier chosen = choose_classifier(options);
    tools_.gcn = std::move(chosen.classifier);
    tools_.pca = planes::make_pca_classifier(options.pca);
    tools_.threads = args_.threads;
    lab::RealResults results;
    results.command = args_.same_command;
    results.build = report::build_info();
    results.weights = *chosen.weights;
    return results;
  }

  std::vector<lab::SetScores> measure_sets() {
    std::vector<lab::CellKey> sets;
    for (const char* errors : {"clean", "d435"})
      for (const std::uint64_t seed : args_.seeds)
        for (const std::string& set : lab::depth_sets())
          sets.push_back(lab::depth_of(set, seed, errors));
    Progress bar("sets", static_cast<int>(sets.size()));
    std::vector<lab::SetScores> scores;
    for (const lab::CellKey& set : sets)
      scores.push_back(lab::measure_set(set, args_.count, tools_, [&](int done, int frames) {
        if (stop_.stop_requested()) throw Cancelled();
        bar.show(
            static_cast<int>(scores.size()),
            fmt::format("{}, seed {}, frame {}/{}", lab::frames_name(set), set.seed, done, frames));
      }));
    return scores;
  }

  const BenchRealArgs& args_;
  std::stop_token stop_;
  lab::CellTools tools_;
};

}  // namespace

const std::vector<std::string>& bench_real_parts() {
  static const std::vector<std::string> parts = {"frames", "sets", "repeat"};
  return parts;
}

int run_bench_real(const BenchRealArgs& args, std::stop_token stop) {
  return RealRun(args, std::move(stop)).run();
}

}  // namespace planescope::app
