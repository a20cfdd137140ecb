// planescope-lab bench real: scores every method by pixel.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/inputs.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/experiments/measure_real.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kRealParts = {"frames", "sets", "repeat"};

struct BenchRealArgs {
  std::set<std::string> parts;  // of kRealParts
  fs::path frames_list;         // for part frames, limited to `half`
  std::optional<lab::Half> half;
  std::vector<lab::ListedFrame> frames;  // for part frames
  fs::path data;                         // folder of recordings, for parts frames and repeat
  fs::path labels;                       // folder of label folders, for part frames
  std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5, 6, 1001, 2001};  // for part sets
  int count = 0;  // maximum frames per set, and of repeat's recording; 0: all
  int threads = all_cores();
  fs::path out;              // -o; empty: stdout
  std::string same_command;  // reproduces the results; without folder names
};

/// A recording for which consecutive frames are compared.
struct Followed {
  const char* name;
  lab::Reading reading = {};
  int step = 1;  // each frame is compared with frame + step
};

/// A robot driving through a room with its camera facing the floor, and a Kinect rotated by hand
/// above a desk at 30 Hz, where consecutive frames share errors.
std::vector<Followed> followed_recordings() {
  Followed pan{"aims_slam_realsense_640x480"}, desk{"tum_fr1_rpy_kinect_640x480"};
  pan.reading.recording.intrinsics = {383.8, 383.8, 321.7, 236.8};
  pan.reading.gravity = {planes::GravityMode::fixed, Vec3d(0.168, 0.925, 0.341)};
  pan.reading.max_range_m = desk.reading.max_range_m = 4;
  Followed slower = desk;
  slower.step = 3;
  return {pan, desk, slower};
}

class RealRun {
 public:
  RealRun(const BenchRealArgs& args, std::stop_token stop) : args_(args), stop_(std::move(stop)) {}

  int run() {
    if (!args_.out.empty()) check_output_dir(args_.out);
    // Report missing files before anything slow starts.
    std::vector<lab::EvaluationFrame> frames;
    for (const lab::ListedFrame& listed : args_.frames)
      frames.push_back(lab::read_listed(listed, args_.data, args_.labels));
    std::vector<std::unique_ptr<io::Recording>> repeated;
    if (wanted("repeat"))
      for (const Followed& of : followed_recordings())
        repeated.push_back(io::open_recording(args_.data / of.name, of.reading.recording));

    const planes::PipelineOptions options;
    planes::ChosenClassifier chosen = choose_classifier(options);
    tools_.gcn = std::move(chosen.classifier);
    tools_.pca = planes::make_pca_classifier(options.pca);
    tools_.threads = args_.threads;
    lab::ResultLines lines("real", args_.same_command, *chosen.weights,
                           {{"least_true_px", lab::kLeastTruePixels},
                            {"least_true_voxels", lab::kMinTruthVoxels},
                            {"least_repeat_px", lab::kLeastRepeatPixels},
                            {"partner_iou", lab::kPartnerIou}});
    if (wanted("frames"))
      for (const lab::MethodScores& method :
           lab::measure_labeled(args_.frames, frames, tools_, Bar("frames", stop_)))
        for (std::size_t i = 0; i < frames.size(); ++i) {
          Json json = json_of(args_.frames[i].name);
          json["method"] = lab::contestant_name(method.method);
          lines.add("labelled", lab::with_metrics(json, method.of_frames[i]));
        }
    if (wanted("sets")) measure_sets(lines);
    if (wanted("repeat")) measure_repeat(repeated, lines);
    deliver(lines, args_.out, "real");
    return 0;
  }

 private:
  bool wanted(const char* part) const { return args_.parts.contains(part); }

  static Json list_of(const auto& values) {
    Json list = Json::array();
    for (const auto& value : values) list.push_back(json_of(value));
    return list;
  }

  /// Measures all methods on the first recording and only ours on the others.
  void measure_repeat(std::span<const std::unique_ptr<io::Recording>> recordings,
                      lab::ResultLines& lines) {
    const std::vector<Followed> followed = followed_recordings();
    for (std::size_t i = 0; i < followed.size(); ++i) {
      std::vector<lab::CellKey> methods = lab::real_methods();
      if (i > 0) methods.resize(1);
      const auto& [name, reading, step] = followed[i];
      for (const lab::RepeatScores& method : lab::measure_repeat(
               *recordings[i], reading, methods, args_.count, step, tools_, Bar("repeat", stop_)))
        lines.add("repeat", {{"recording", name},
                             {"step", step},
                             {"method", lab::contestant_name(method.method)},
                             {"neighbours", list_of(method.neighbors)},
                             {"floor", list_of(method.floor)}});
    }
  }

  void measure_sets(lab::ResultLines& lines) {
    std::vector<lab::CellKey> sets;
    for (const char* errors : {"clean", "d435"})
      for (const std::uint64_t seed : args_.seeds)
        for (const std::string& set : lab::depth_sets())
          sets.push_back(lab::depth_of(set, seed, errors));
    Progress bar("sets", static_cast<int>(sets.size()));
    for (std::size_t i = 0; i < sets.size(); ++i) {
      const lab::CellKey& set = sets[i];
      const auto show = [&](int done, int frames) {
        if (stop_.stop_requested()) throw Cancelled();
        bar.show(static_cast<int>(i), fmt::format("{}, seed {}, frame {}/{}", lab::frames_name(set),
                                                  set.seed, done, frames));
      };
      for (const lab::MethodScores& method : lab::measure_set(set, args_.count, tools_, show))
        for (const planes::Metrics& metrics : method.of_frames)
          lines.add("set", lab::with_metrics({{"set", set.set},
                                              {"errors", set.errors},
                                              {"seed", set.seed},
                                              {"method", lab::contestant_name(method.method)}},
                                             metrics));
    }
  }

  const BenchRealArgs& args_;
  std::stop_token stop_;
  lab::CellTools tools_;
};

/// Scores every method by pixel: on labeled frames, on depth sets with several seeds, and from
/// frame to frame. Throws Cancelled on stop.
int run_bench_real(const BenchRealArgs& args, std::stop_token stop) {
  return RealRun(args, std::move(stop)).run();
}

// ---- List of labeled frames ----

lab::Half parse_half(const std::string& text) {
  for (const lab::Half half : {lab::Half::tuning, lab::Half::printed})
    if (text == lab::to_string(half)) return half;
  throw Error("unknown half '" + text + "' of the frame list; expected tuning or printed");
}

lab::ListedFrame listed_frame(std::istringstream& words) {
  static const std::vector<std::string> options = {"--intrinsics", "--depth-unit", "--gravity",
                                                   "--max-range"};
  lab::ListedFrame listed;
  lab::LabeledName& name = listed.name;
  std::string half, frame;
  if (!(words >> name.name >> half >> name.recording >> frame))
    throw Error("expected NAME HALF RECORDING FRAME OPTIONS");
  name.half = parse_half(half);
  name.frame = parse_integer(frame, "FRAME");
  if (name.frame < 0) throw Error("FRAME: " + frame + " is out of range; expected at least 0");
  InputArgs input;
  set_listed_options(input, words, options);
  listed.reading = {input.recording, input.pipeline.gravity, input.pipeline.cloud.max_range_m};
  return listed;
}

/// Reads a list like tests/real/labels/list.txt and returns the frames of one half or both. Throws
/// Error if no frame is left, or with the list and line number if a line is invalid.
std::vector<lab::ListedFrame> labeled_list(const fs::path& list, std::optional<lab::Half> half) {
  std::vector<lab::ListedFrame> frames;
  read_list(list, [&](std::istringstream& words) {
    lab::ListedFrame listed = listed_frame(words);
    if (std::ranges::any_of(
            frames, [&](const lab::ListedFrame& f) { return f.name.name == listed.name.name; }))
      throw Error(listed.name.name + " appears twice");
    frames.push_back(std::move(listed));
  });
  if (half) std::erase_if(frames, [&](const lab::ListedFrame& f) { return f.name.half != *half; });
  if (frames.empty())
    throw Error(list.string() + ": lists no frames" +
                (half ? fmt::format(" for the {} half", lab::to_string(*half)) : ""));
  return frames;
}

void finish(BenchRealArgs& args, const CLI::App& typed) {
  if (args.parts.empty()) args.parts = {kRealParts.begin(), kRealParts.end()};
  const bool frames = args.parts.contains("frames");
  if (frames && args.frames_list.empty())
    throw Error("bench real needs a list of labeled frames, --frames-list FILE");
  if (frames && args.labels.empty())
    throw Error("bench real needs the frames' label folder, --labels DIR");
  if (frames || args.parts.contains("repeat")) {
    if (args.data.empty()) args.data = data_folder();
    if (args.data.empty())
      throw Error("bench real needs the recordings folder, --data DIR or PLANESCOPE_DATA");
    if (!fs::is_directory(args.data))
      throw Error("--data: " + args.data.string() + " is not a folder");
  }
  if (frames) {
    args.frames = labeled_list(args.frames_list, args.half);
    if (!fs::is_directory(args.labels))
      throw Error("--labels: " + args.labels.string() + " is not a folder");
  }
  for (const std::uint64_t seed : args.seeds)
    if (std::ranges::count(args.seeds, seed) > 1)
      throw Error(fmt::format("--seeds: {} appears twice", seed));
  args.same_command = "planescope-lab bench real";
  if (!args.frames_list.empty())
    args.same_command += " --frames-list " + args.frames_list.filename().string();
  args.same_command += typed_text(typed, {"--only", "--half", "--seeds", "--count"});
}

}  // namespace

void define_bench_real(CLI::App* bench, Line& line) {
  CLI::App* real =
      bench->add_subcommand("real",
                            "Score every method per pixel\n"
                            "Measures on labeled frames of real recordings, on depth sets of many "
                            "seeds, and from frame to frame of a recording. -o writes real.jsonl.");
  const auto args = std::make_shared<BenchRealArgs>();
  add(real, "--frames-list", args->frames_list, "FILE",
      "File with one line per labeled frame: NAME HALF RECORDING FRAME OPTIONS; OPTIONS are "
      "--intrinsics, --depth-unit, --gravity, and --max-range");
  add(real, "--data", args->data, "DIR", "Folder of the recordings (default $PLANESCOPE_DATA)");
  add(real, "--labels", args->labels, "DIR",
      "Folder with a label folder NAME for each listed frame");
  add_out(real, args->out);
  add_parts(real, args->parts, kRealParts,
            fmt::format("Parts to measure: {} (default: all)", fmt::join(kRealParts, ", ")));
  add_read(
      real, "--half", [args](const std::string& text) { args->half = parse_half(text); },
      "tuning|printed", "Half of the listed frames to measure (default: both)");
  add(real, "--seeds", args->seeds, "N,...",
      "Random seeds of the depth sets (default 1,2,3,4,5,6,1001,2001)")
      ->transform(whole(1));
  add(real, "--count", args->count, "N",
      "Maximum number of frames of each set and of the tracked recording (default all)")
      ->transform(whole(1));
  add_threads(real, args->threads);
  runs(real, line, args, run_bench_real, [args, real] { finish(*args, *real); });
}

}  // namespace planescope::app
