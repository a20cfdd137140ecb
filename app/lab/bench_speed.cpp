#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/allocations.hpp"
#include "app/lab/lab.hpp"
#include "app/lab/speed_subjects.hpp"
#include "core/io/open3d/install.hpp"
#include "core/lab/bench/speed_page.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSpeedParts = {"stages", "frames", "scaling", "memory", "start"};

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

/// A folder of its own below the system's for temporary files, gone with its owner.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "planescope-lab.XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error(name + ": cannot be made: " + std::strerror(errno));
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

class SpeedRun {
 public:
  SpeedRun(const BenchSpeedArgs& args, std::stop_token stop)
      : args_(args), stop_(std::move(stop)) {}

  int run() {
    check_output_dir(args_.out);
    // What cannot be read or found is told before anything slow starts.
    load_tools();
    read_subjects();
    if (wanted("start")) find_commands();
    const lab::ChainSpeed speed = measure();
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
    if (planes::has_ransac()) {  // Open3D is here
      tools_.open3d_voxels = open3d::voxel_down_sample;
      tools_.open3d_octree = open3d::pointer_octree;
    }
    tools_.count_allocations = allocation_counter();
  }

  /// Of the product itself, which stands beside this program. Each runs once, so that one which
  /// fails is told before anything slow starts.
  void find_commands() {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "planescope";
    if (!fs::exists(program))
      throw Error("part start: " + program.string() +
                  " is missing, expected it beside this program");
    commands_ = {{"planescope --version", {program.string(), "--version"}}};
    scratch_.emplace();
    for (const auto& open : subjects_) {
      if (open->input.path.empty()) continue;  // made, not recorded
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
    for (OpenInput& input : open_inputs(args_.input)) {
      check_stop();
      subjects_.push_back(read_subject(std::move(input), options));
    }
  }

  lab::ChainSpeed measure() {
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

    bar_.emplace("bench speed", static_cast<int>(args_.parts.size() * subjects_.size()));
    for (const auto& open : subjects_) measure_subject(open->subject, speed);
    if (begin("scaling")) speed.scaling = lab::measure_scaling(subjects_[0]->subject, tools_);
    if (begin("start"))
      speed.commands =
          lab::measure_commands(commands_, args_.rounds, [this] { tools_.before("planescope"); });
    bar_.reset();
    return speed;
  }

  void measure_subject(const lab::SpeedSubject& subject, lab::ChainSpeed& speed) {
    const auto append = [](auto& rows, auto more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    if (begin("stages")) {
      append(speed.stages, lab::measure_stages(subject, tools_));
      append(speed.duels, lab::measure_duels(subject, tools_));
    }
    if (begin("frames")) append(speed.methods, lab::measure_methods(subject, tools_));
    if (begin("memory")) {
      append(speed.stage_memory, lab::measure_stage_memory(subject, tools_));
      append(speed.method_memory, lab::measure_method_memory(subject, tools_));
    }
  }

  /// Whether the part is wanted; turns from here on are its own.
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
  std::vector<std::shared_ptr<OpenSubject>> subjects_;
  std::optional<ScratchFolder> scratch_;  // what commands write, while they are timed
  std::vector<lab::TimedCommand> commands_;
  std::optional<Progress> bar_;
  int begun_ = 0;  // parts
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
             io::recordings_text(true) +
                 " whose frames are timed, ten of each at most;\n"
                 "without, depth_stairs, a synthetic set with a camera's errors");
  speed->remove_option(speed->get_option("--labels"));
  add_of_method(speed, pipeline, "--gravity", "auto|X,Y,Z|imu|estimate",
                "Direction in which things fall, as in planescope segment");
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
