#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/cli/assets.hpp"
#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/allocations.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/speed_page.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSpeedParts = {"stages", "frames", "scaling", "memory", "start"};
constexpr std::size_t kMostFrames = 10;  // of each recording, evenly spread

struct BenchSpeedArgs {
  InputArgs input;
  std::string weights = "gcn";
  std::set<std::string> parts;  // of kSpeedParts
  int rounds = 20;
  int most_points = 1'000'000;
  fs::path out;  // -o
  bool json = false;
  std::string command;                       // as it was typed
  std::vector<std::string> reading_options;  // of it, those that `segment` takes as well
};

/// A recording that is open for as long as its frames are read again.
struct OpenSubject {
  OpenInput input;
  lab::SpeedSubject subject;
};

/// Throws Error where none of its frames can be read and tells, or is told, which way is down.
std::shared_ptr<OpenSubject> read_subject(OpenInput input, const planes::PipelineOptions& options) {
  const auto open = std::make_shared<OpenSubject>();
  open->input = std::move(input);
  const io::Recording& recording = *open->input.recording;
  lab::SpeedSubject& subject = open->subject;
  subject.name = fs::absolute(open->input.path / "").parent_path().filename().string();
  subject.options = options;
  const std::vector<int>& all = open->input.frames;
  const std::size_t used = std::min(all.size(), kMostFrames);
  std::vector<int> numbers;
  std::string refusal;
  for (std::size_t i = 0; i < used; ++i) {
    const int number = all[i * all.size() / used];
    Frame frame = recording.frame(number);
    try {
      const Gravity gravity = planes::resolve_gravity(frame, options.gravity);
      const planes::Cloud cloud = planes::make_cloud(frame, gravity, options.cloud);
      if (cloud.counts.kept == 0) throw Error("nothing of it is within range");
    } catch (const Error& error) {
      refusal = fmt::format("{}, frame {}: {}", open->input.path.string(), number, error.what());
      continue;
    }
    numbers.push_back(number);
    subject.frames.push_back(std::move(frame));
  }
  if (subject.frames.empty()) throw Error(refusal);
  subject.load = [&recording, numbers](std::size_t i) { return recording.frame(numbers[i]); };
  return open;
}

/// What is measured where no recording is given: the same bytes everywhere, and camera errors.
std::shared_ptr<OpenSubject> made_subject(const planes::PipelineOptions& options) {
  const auto made = std::make_shared<OpenSubject>();
  const lab::EvaluationSet& set = lab::find_evaluation_set("depth_stairs");
  made->subject.name = "depth_stairs, d435";
  made->subject.options = options;
  for (int i = 0; i < std::min(set.frames, static_cast<int>(kMostFrames)); ++i)
    made->subject.frames.push_back(
        lab::make_evaluation_frame(set, i, {.errors = lab::DepthErrors::d435}).frame);
  return made;
}

class SpeedRun {
 public:
  SpeedRun(const BenchSpeedArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)) {}

  int run() {
    check_output_dir(args_.out);
    // What cannot be read or found is told before anything slow starts.
    load_tools();
    const std::vector<lab::TimedCommand> commands = wanted("start") ? timed_commands() : kNone;
    read_subjects();
    const lab::ChainSpeed speed = measure(commands);
    make_output_dir(args_.out);
    const std::string json = lab::speed_json(speed);
    write_file_text(args_.out / "speed.json", json);
    write_file_text(args_.out / "index.html", lab::speed_page(speed));
    if (args_.json)
      fmt::print("{}", json);
    else
      fmt::print("{}\nAll of it as a page: {}\n", joined(lab::speed_tables(speed), lab::to_text),
                 (args_.out / "index.html").string());
    return 0;
  }

 private:
  static inline const std::vector<lab::TimedCommand> kNone;

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
                  "' is not a network, expected gcn or a weights file");
    weights_ = *chosen.weights;
    tools_.gcn = std::move(chosen.classifier);
    tools_.network = planes::read_weights(file).config;
    tools_.pca_options = args_.input.pipeline.pca;
    tools_.pca = planes::make_pca_classifier(tools_.pca_options);
    tools_.rounds = args_.rounds;
    tools_.threads = args_.input.pipeline.threads;
    tools_.most_points = args_.most_points;
    tools_.count_allocations = allocation_counter();
  }

  /// The product itself, which stands beside this program.
  std::vector<lab::TimedCommand> timed_commands() const {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "planescope";
    if (!fs::exists(program))
      throw Error("part start: " + program.string() +
                  " is missing, expected it beside this program");
    std::vector<lab::TimedCommand> commands = {
        {"planescope --version", {program.string(), "--version"}}};
    for (const fs::path& input : args_.input.inputs) {
      lab::TimedCommand info{"planescope info " + input.filename().string(),
                             {program.string(), "info", input.string()}};
      commands.push_back(std::move(info));
    }
    return commands;
  }

  void read_subjects() {
    const planes::PipelineOptions& options = args_.input.pipeline;
    if (args_.input.inputs.empty()) {
      subjects_.push_back(made_subject(options));
      return;
    }
    for (OpenInput& input : open_inputs(args_.input)) {
      check_stop();
      subjects_.push_back(read_subject(std::move(input), options));
    }
  }

  lab::ChainSpeed measure(const std::vector<lab::TimedCommand>& commands) {
    lab::ChainSpeed speed;
    speed.command = args_.command;
    speed.build = report::build_info();
    speed.weights = weights_;
    speed.machine = lab::this_machine();
    speed.rounds = args_.rounds;
    speed.threads = tools_.threads;
    for (const auto& open : subjects_) {
      const Frame& first = open->subject.frames[0];
      speed.subjects.push_back({open->subject.name, static_cast<int>(open->subject.frames.size()),
                                first.depth.width, first.depth.height});
    }
    if (wanted("stages")) speed.peaks = tools_.peaks = lab::measure_peaks();

    int done = 0;
    Progress bar("bench speed", static_cast<int>(args_.parts.size() * subjects_.size()));
    const auto begin_part = [&](const char* part) {
      tools_.before = [this, part, &bar, &done](const std::string& what) {
        check_stop();
        bar.show(done, fmt::format("{}: {}", part, what));
      };
    };
    const auto append = [](auto& rows, auto more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    for (const auto& open : subjects_) {
      const lab::SpeedSubject& subject = open->subject;
      if (wanted("stages")) {
        begin_part("stages");
        append(speed.stages, lab::measure_stages(subject, tools_));
        ++done;
      }
      if (wanted("frames")) {
        begin_part("frames");
        append(speed.methods, lab::measure_methods(subject, tools_));
        ++done;
      }
      if (wanted("memory")) {
        begin_part("memory");
        lab::Memory memory = lab::measure_memory(subject, tools_);
        append(speed.memory.stages, std::move(memory.stages));
        append(speed.memory.methods, std::move(memory.methods));
        ++done;
      }
    }
    if (wanted("scaling")) {
      begin_part("scaling");
      speed.scaling = lab::measure_scaling(subjects_[0]->subject, tools_);
      ++done;
    }
    if (wanted("start")) {
      begin_part("start");
      speed.commands =
          lab::measure_commands(commands, args_.rounds, [this] { tools_.before("planescope"); });
    }
    return speed;
  }

  const BenchSpeedArgs& args_;
  std::stop_token stop_;
  lab::SpeedTools tools_;
  planes::WeightsRecord weights_;
  std::vector<std::shared_ptr<OpenSubject>> subjects_;
};

/// How fast everything is: speed.json and index.html, and the tables on stdout. Returns 0; throws
/// Cancelled on stop.
int run_bench_speed(const BenchSpeedArgs& args, std::stop_token stop) {
  return SpeedRun(args, std::move(stop)).run();
}

}  // namespace

void define_bench_speed(CLI::App* bench, Line& line) {
  CLI::App* speed = bench->add_subcommand(
      "speed",
      "How fast everything is: each stage beside its floor, whole frames beside other methods,\n"
      "how times grow, memory, and what it costs to start. Writes speed.json and index.html.");
  const auto args = std::make_shared<BenchSpeedArgs>();
  planes::PipelineOptions& pipeline = args->input.pipeline;
  add_inputs(speed, args->input,
             "Bags, folders, .raw, .ply or .pcd files whose frames are timed, ten of each at most; "
             "without, depth_stairs, a synthetic set with a camera's errors");
  speed->remove_option(speed->get_option("--labels"));
  add_of_method(speed, pipeline, "--gravity", "auto|X,Y,Z|imu|estimate",
                "As in planescope segment; likewise:");
  add_of_method(speed, pipeline, "--max-range", "M", "Crop what is farther, default 1.5");
  add_of_method(speed, pipeline, "--voxel", "M", "Edge of the voxel grid, default 0.02");
  add_out(speed, args->out)->required();
  add_json(speed, args->json);
  add(speed, "--weights", args->weights, "gcn|FILE",
      "The network: gcn, the one that comes with planescope (default), or a file");
  add_parts(speed, args->parts, kSpeedParts,
            fmt::format("Of {}; default: all", fmt::join(kSpeedParts, ", ")));
  add(speed, "--rounds", args->rounds, "N", "How often each thing is measured, default 20")
      ->transform(whole(1));
  add(speed, "--most-points", args->most_points, "N",
      "Of the clouds that scaling is measured on, default 1000000")
      ->transform(whole(1000));
  add(speed, "--threads", pipeline.threads, "N",
      "The most that scaling is measured with, default all cores; all else takes one")
      ->transform(whole(1, 1024));
  runs(speed, line, args, run_bench_speed, [args, &line] {
    expect_gravity(args->input.pipeline, "bench speed");
    if (args->parts.empty()) args->parts = {kSpeedParts.begin(), kSpeedParts.end()};
    args->command = line.text;
  });
}

}  // namespace planescope::app
