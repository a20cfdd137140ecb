// planescope-lab bench speed: run times and allocations of every step.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/io/open3d/install.hpp"
#include "core/lab/bench/scaling.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kSpeedParts = {"stages", "frames", "scaling", "memory", "start"};

struct BenchSpeedArgs {
  InputArgs input;
  std::string weights = "gcn";
  std::set<std::string> parts;  // of kSpeedParts
  int rounds = 20;
  int most_points = 1'000'000;
  fs::path out;                              // -o; empty: stdout
  std::string command;                       // as typed
  std::vector<std::string> reading_options;  // the options in it that `segment` supports too
};

/// A folder below the system's folder for temporary files, removed by the destructor.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "planescope-lab.XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error(name + ": cannot be created: " + std::strerror(errno));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A recording that stays open so that its frames can be read repeatedly.
struct OpenSubject {
  OpenInput input;
  std::vector<int> numbers;  // frame numbers in the recording
  lab::SpeedSubject subject;
};

constexpr int kMostFrames = 10;

/// Reads at most ten frames, evenly spaced. Throws Error if no frame is readable with known gravity
/// and points within range.
std::shared_ptr<OpenSubject> read_subject(OpenInput input, const planes::PipelineOptions& options) {
  const auto open = std::make_shared<OpenSubject>();
  open->input = std::move(input);
  const io::Recording& recording = *open->input.recording;
  lab::SpeedSubject& subject = open->subject;
  subject.name = std::filesystem::absolute(open->input.path / "").parent_path().filename().string();
  subject.options = options;
  std::string refusal;
  for (const int number : spread(open->input.frames, kMostFrames)) {
    Frame frame = recording.frame(number);
    try {
      const Gravity gravity = planes::resolve_gravity(frame, options.gravity);
      const planes::Cloud cloud = planes::make_cloud(frame, gravity, options.cloud);
      if (cloud.counts.kept == 0) throw Error("no points are within range");
    } catch (const Error& error) {
      refusal = fmt::format("{}, frame {}: {}", open->input.path.string(), number, error.what());
      continue;
    }
    open->numbers.push_back(number);
    subject.frames.push_back(std::move(frame));
  }
  if (subject.frames.empty()) throw Error(refusal);
  subject.load = [&recording, numbers = open->numbers](std::size_t i) {
    return recording.frame(numbers[i]);
  };
  return open;
}

/// The default subject: depth_stairs with simulated camera errors, identical on every machine.
std::shared_ptr<OpenSubject> made_subject(const planes::PipelineOptions& options) {
  const auto made = std::make_shared<OpenSubject>();
  const lab::EvaluationSet& set = lab::find_evaluation_set("depth_stairs");
  made->subject.name = "depth_stairs, d435";
  made->subject.options = options;
  for (int i = 0; i < std::min(set.frames, kMostFrames); ++i)
    made->subject.frames.push_back(
        lab::make_evaluation_frame(set, i, {.errors = lab::DepthErrors::d435}).frame);
  return made;
}

class SpeedRun {
 public:
  SpeedRun(const BenchSpeedArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)) {}

  int run() {
    if (!args_.out.empty()) check_output_dir(args_.out);
    // Report unreadable and missing files before anything slow starts.
    load_tools();
    read_subjects();
    if (wanted("start")) find_commands();
    deliver(measure(), args_.out, "speed");
    return code_;
  }

 private:
  bool wanted(const char* part) const { return args_.parts.contains(part); }
  void check_stop() const {
    if (stop_.stop_requested()) throw Cancelled();
  }

  void load_tools() {
    planes::PipelineOptions options;
    options.classifier = args_.weights;
    const fs::path file = args_.weights == "gcn"
                              ? find_asset("classifier.safetensors", "the weights of gcn are")
                              : fs::path(args_.weights);
    planes::ChosenClassifier chosen = planes::make_classifier(options, file);
    if (!chosen.weights)
      throw Error("--weights: '" + args_.weights +
                  "' is not a network; expected gcn or a weights file");
    weights_ = *chosen.weights;
    tools_.gcn = std::move(chosen.classifier);
    tools_.network = planes::read_weights(file).config;
    tools_.pca_options = args_.input.pipeline.pca;
    tools_.pca = planes::make_pca_classifier(tools_.pca_options);
    tools_.rounds = args_.rounds;
    tools_.threads = args_.input.pipeline.threads;
    tools_.most_points = args_.most_points;
    if (planes::has_ransac()) {  // Open3D is available
      tools_.open3d_voxels = open3d::voxel_down_sample;
      tools_.open3d_octree = open3d::pointer_octree;
    }
    tools_.count_allocations = allocation_counter();
  }

  /// Prepares commands of the planescope executable beside this program. Runs each once, so that a
  /// failure is reported before anything slow starts.
  void find_commands() {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "planescope";
    if (!fs::exists(program))
      throw Error("part start: " + program.string() +
                  " is missing; expected it next to this program");
    commands_ = {{"planescope --version", {program.string(), "--version"}}};
    scratch_.emplace();
    for (const auto& open : subjects_) {
      if (open->input.path.empty()) continue;  // synthetic
      std::vector<std::string> args = {program.string(), "segment", open->input.path.string()};
      args.insert(args.end(), args_.reading_options.begin(), args_.reading_options.end());
      for (const std::string& arg :
           {std::string("--frames"), std::to_string(open->numbers[0]), std::string("--threads"),
            std::string("1"), std::string("-o"), scratch_->path().string()})
        args.push_back(arg);
      commands_.push_back({"planescope segment " + open->subject.name + ", one frame", args});
    }
    lab::measure_commands(commands_, 1, [this] { check_stop(); });
  }

  void read_subjects() {
    const planes::PipelineOptions& options = args_.input.pipeline;
    if (args_.input.inputs.empty()) {
      subjects_.push_back(made_subject(options));
      return;
    }
    std::vector<OpenInput> inputs = open_inputs(args_.input, args_.out);
    code_ = leave_out_damaged(inputs);
    for (OpenInput& input : inputs) {
      check_stop();
      subjects_.push_back(read_subject(std::move(input), options));
    }
  }

  lab::ResultLines measure() {
    Json facts = {{"machine", lab::machine_json(lab::this_machine())},
                  {"rounds", args_.rounds},
                  {"threads", tools_.threads}};
    if (wanted("stages")) {
      tools_.peaks = lab::measure_peaks();
      facts["bytes_per_s"] = tools_.peaks.bytes_per_s;
      facts["flops_per_s"] = tools_.peaks.flops_per_s;
    }
    lab::ResultLines lines("speed", args_.command, weights_, facts);
    for (const auto& open : subjects_) {
      const Frame& first = open->subject.frames[0];
      lines.add("subject", {{"name", open->subject.name},
                            {"frames", open->subject.frames.size()},
                            {"width", first.depth.width},
                            {"height", first.depth.height}});
    }
    bar_.emplace("bench speed", static_cast<int>(args_.parts.size() * subjects_.size()));
    for (const auto& open : subjects_) measure_subject(open->subject, lines);
    if (begin("scaling"))
      for (const lab::Scaling& scaling : lab::measure_scaling(subjects_[0]->subject, tools_))
        lines.add("scaling", json_of(scaling));
    if (begin("start"))
      for (const lab::CommandRow& row :
           lab::measure_commands(commands_, args_.rounds, [this] { tools_.before("planescope"); }))
        lines.add("command", json_of(row));
    bar_.reset();
    return lines;
  }

  void measure_subject(const lab::SpeedSubject& subject, lab::ResultLines& lines) {
    const auto add_rows = [&](const char* kind, const auto& rows) {
      for (const auto& row : rows) {
        Json json = {{"recording", subject.name}};
        json.update(json_of(row));
        lines.add(kind, json);
      }
    };
    if (begin("stages")) {
      add_rows("stage", lab::measure_stages(subject, tools_));
      add_rows("duel", lab::measure_duels(subject, tools_));
    }
    if (begin("frames")) add_rows("method", lab::measure_methods(subject, tools_));
    if (begin("memory")) {
      add_rows("stage_memory", lab::measure_stage_memory(subject, tools_));
      add_rows("method_memory", lab::measure_method_memory(subject, tools_));
    }
  }

  /// Whether the part is selected; if so, later progress belongs to it.
  bool begin(const char* part) {
    if (!wanted(part)) return false;
    tools_.before = [this, part, number = begun_++](const std::string& what) {
      check_stop();
      bar_->show(number, fmt::format("{}: {}", part, what));
    };
    return true;
  }

  const BenchSpeedArgs& args_;
  std::stop_token stop_;
  lab::SpeedTools tools_;
  planes::WeightsRecord weights_;
  int code_ = 0;  // 2: damaged frames were left out
  std::vector<std::shared_ptr<OpenSubject>> subjects_;
  std::optional<ScratchFolder> scratch_;  // output of the timed commands
  std::vector<lab::TimedCommand> commands_;
  std::optional<Progress> bar_;
  int begun_ = 0;  // number of parts begun
};

/// Runs the benchmark. Throws Cancelled on stop.
int run_bench_speed(const BenchSpeedArgs& args, std::stop_token stop) {
  return SpeedRun(args, std::move(stop)).run();
}

}  // namespace

void define_bench_speed(CLI::App* bench, Line& line) {
  CLI::App* speed =
      bench->add_subcommand("speed",
                            "Time every stage and method\n"
                            "Measures each stage against its lower bound, whole frames against "
                            "other methods, scaling, memory, and startup. -o writes speed.jsonl.");
  const auto args = std::make_shared<BenchSpeedArgs>();
  planes::PipelineOptions& pipeline = args->input.pipeline;
  add_inputs(speed, args->input,
             io::recordings_text(true) +
                 "; times at most ten frames of each (default: the synthetic set depth_stairs)");
  speed->remove_option(speed->get_option("--labels"));
  add_of_method(speed, pipeline, "--gravity", "auto|X,Y,Z|imu|estimate",
                "Gravity direction in the sensor's frame (default auto)");
  add_of_method(speed, pipeline, "--max-range", "M", "Maximum range in meters (default 1.5)");
  add_of_method(speed, pipeline, "--voxel", "M", "Voxel edge in meters (default 0.02)");
  add_out(speed, args->out);
  add(speed, "--weights", args->weights, "gcn|FILE",
      "Network: gcn, the built-in one (default), or a file");
  add_parts(speed, args->parts, kSpeedParts,
            fmt::format("Parts to measure: {} (default: all)", fmt::join(kSpeedParts, ", ")));
  add(speed, "--rounds", args->rounds, "N", "Repetitions of each timing (default 20)")
      ->transform(whole(1));
  add(speed, "--most-points", args->most_points, "N",
      "Points of the largest cloud for scaling (default 1000000)")
      ->transform(whole(1000));
  add(speed, "--threads", pipeline.threads, "N",
      "Maximum number of threads for scaling (default all cores); other parts use one")
      ->transform(whole(1, 1024));
  runs(speed, line, args, run_bench_speed, [args, speed, &line] {
    for (const char* name : {"--intrinsics", "--depth-unit", "--instance-field", "--read-limit",
                             "--gravity", "--max-range", "--voxel"})
      if (const CLI::Option* option = speed->get_option(name); option->count() > 0) {
        args->reading_options.emplace_back(name);
        args->reading_options.push_back(CLI::detail::join(option->results(), ","));
      }
    expect_gravity(args->input.pipeline, "bench speed");
    if (args->parts.empty()) args->parts = {kSpeedParts.begin(), kSpeedParts.end()};
    args->command = line.text;
  });
}

}  // namespace planescope::app
