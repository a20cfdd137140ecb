#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "app/lab/lists.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/real_results.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kRealParts = {"frames", "sets", "repeat"};

struct BenchRealArgs {
  std::set<std::string> parts;  // of kRealParts
  fs::path frames_list;         // of part frames, and these of it:
  std::optional<lab::Half> half;
  std::vector<lab::ListedFrame> frames;  // of part frames
  fs::path data;                         // folder of the recordings; of parts frames and repeat
  fs::path labels;                       // folder of the labels' folders; of part frames
  std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5, 6, 1001, 2001};  // of part sets
  int count = 0;  // frames of a set and of repeat's recording at most; 0: all
  int threads = all_cores();
  fs::path out;  // -o
  bool json = false;
  std::string same_command;  // measures the same again; without folders, which are this machine's
};

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

/// Every method by pixel: on labelled frames, on depth sets of many seeds, from frame to frame.
/// Writes real.json and real.md, prints the tables, and returns 0; throws Cancelled on stop.
int run_bench_real(const BenchRealArgs& args, std::stop_token stop) {
  return RealRun(args, std::move(stop)).run();
}

void finish(BenchRealArgs& args, const CLI::App& typed) {
  if (args.parts.empty()) args.parts = {kRealParts.begin(), kRealParts.end()};
  const bool frames = args.parts.contains("frames");
  if (frames && args.frames_list.empty())
    throw Error("bench real needs a list of labelled frames, --frames-list FILE");
  if (frames && args.labels.empty())
    throw Error("bench real needs the folder of the frames' labels, --labels DIR");
  if (frames || args.parts.contains("repeat")) {
    if (args.data.empty()) args.data = data_folder();
    if (args.data.empty())
      throw Error("bench real needs the folder of recordings, --data DIR or PLANESCOPE_DATA");
    if (!fs::is_directory(args.data))
      throw Error("--data: " + args.data.string() + " is not a folder");
  }
  if (frames) {
    args.frames = labelled_list(args.frames_list, args.half);
    if (!fs::is_directory(args.labels))
      throw Error("--labels: " + args.labels.string() + " is not a folder");
  }
  for (const std::uint64_t seed : args.seeds)
    if (std::ranges::count(args.seeds, seed) > 1)
      throw Error(fmt::format("--seeds: {} is there twice", seed));
  args.same_command = "planescope-lab bench real";
  if (!args.frames_list.empty())
    args.same_command += " --frames-list " + args.frames_list.filename().string();
  args.same_command += typed_text(typed, {"--only", "--half", "--seeds", "--count"});
}

}  // namespace

void define_bench_real(CLI::App* bench, Line& line) {
  CLI::App* real = bench->add_subcommand(
      "real",
      "Every method by pixel: on labelled frames of real recordings, on depth sets of many seeds,\n"
      "and from frame to frame of a recording. Writes real.json and real.md.");
  const auto args = std::make_shared<BenchRealArgs>();
  add(real, "--frames-list", args->frames_list, "FILE",
      "Lines of NAME HALF RECORDING FRAME OPTIONS: the labelled frames, with --intrinsics, "
      "--depth-unit, --gravity and --max-range as they need them");
  add(real, "--data", args->data, "DIR", "Folder of the recordings; default $PLANESCOPE_DATA");
  add(real, "--labels", args->labels, "DIR",
      "Where the folder NAME holds the labels of each frame that is listed");
  add_out(real, args->out)->required();
  add_json(real, args->json);
  add_parts(real, args->parts, kRealParts,
            fmt::format("Of {}; default: all", fmt::join(kRealParts, ", ")));
  add_read(
      real, "--half", [args](const std::string& text) { args->half = lab::parse_half(text); },
      "tuning|printed", "Listed frames of this half alone; default: both");
  add(real, "--seeds", args->seeds, "N,...", "Of the depth sets, default 1,2,3,4,5,6,1001,2001")
      ->transform(whole(1));
  add(real, "--count", args->count, "N",
      "At most so many frames of each set, and of the recording that is followed; default all")
      ->transform(whole(1));
  add_threads(real, args->threads);
  runs(real, line, args, run_bench_real, [args, real] { finish(*args, *real); });
}

}  // namespace planescope::app
