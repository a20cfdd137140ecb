// Opens recordings and parses frame slices, input options and method options.

#include "app/commands/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace fs = std::filesystem;

FrameSlice parse_frame_slice(const std::string& text) {
  const auto part = [&](const std::string& s) -> std::optional<int> {
    if (s.empty()) return std::nullopt;
    return parse_integer(s, "--frames " + text);
  };
  const std::vector<std::string> parts = split(text, ':');
  if (text.empty() || parts.size() > 3)
    throw Error("--frames '" + text + "' is not A:B:STEP or a frame number");
  FrameSlice slice;
  slice.first = part(parts[0]);
  if (parts.size() == 1) {
    // A single frame. -1 is the last one, so its slice ends at the end of the recording.
    if (slice.first != -1) slice.last = *slice.first + 1;
    return slice;
  }
  slice.last = part(parts[1]);
  if (parts.size() == 3) slice.step = part(parts[2]);
  if (slice.step && *slice.step < 1)
    throw Error("--frames " + text + ": the step is " + parts[2] + "; expected at least 1");
  return slice;
}

std::vector<int> sliced_frames(const FrameSlice& slice, int frame_count) {
  const auto clamped = [&](int i) {
    return std::clamp(i < 0 ? i + frame_count : i, 0, frame_count);
  };
  std::vector<int> frames;
  const int end = clamped(slice.last.value_or(frame_count));
  for (int i = clamped(slice.first.value_or(0)); i < end; i += slice.step.value_or(1)) {
    frames.push_back(i);
    if (slice.step.value_or(1) >= frame_count) break;  // i + step might overflow
  }
  return frames;
}

bool is_in_slice(const FrameSlice& slice, int frame) {
  const int first = slice.first.value_or(0);
  return frame >= first && !is_past_slice(slice, frame) &&
         (frame - first) % slice.step.value_or(1) == 0;
}

bool is_past_slice(const FrameSlice& slice, int frame) {
  if (slice.first.value_or(0) < 0 || slice.last.value_or(0) < 0)
    throw Error("--frames: a stream cannot be indexed from its end; expected numbers from 0");
  return slice.last && frame >= *slice.last;
}

int all_cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

namespace {

/// Radius of a disc, or of the circumscribed circle of a rectangle LENGTHxWIDTH [m].
double foot_radius_m(const std::string& text) {
  std::vector<double> sizes;
  for (const std::string& side : split(text, 'x')) sizes.push_back(parse_number(side).value_or(0));
  const auto is_size = [](double size) { return size > 0 && std::isfinite(size); };
  if (sizes.size() > 2 || !std::ranges::all_of(sizes, is_size))
    throw Error(
        "--foot: '" + text +
        "' is not a size; expected RADIUS or LENGTHxWIDTH in meters, such as 0.1 or 0.2x0.1");
  return sizes.size() == 1 ? sizes[0] : std::hypot(sizes[0], sizes[1]) / 2;
}

}  // namespace

void set_pipeline_option(planes::PipelineOptions& options,
                         const std::string& name,
                         const std::string& text) {
  if (text.empty()) return;  // an unset shell variable
  if (name == "--set") {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw Error("--set: '" + text + "' is not NAME=VALUE");
    return planes::set_option(options, text.substr(0, equals), text.substr(equals + 1));
  }
  if (name == "--profile") return planes::set_profile(options, text);
  if (name == "--foot")
    return planes::set_option(options, "foot_radius_m", fmt::format("{}", foot_radius_m(text)));
  const std::string option = name == "--max-range" ? "max_range_m"
                             : name == "--voxel"   ? "voxel_size_m"
                                                   : name.substr(2);
  planes::set_option(options, option, text);
  if (name == "--max-range")
    options.cloud.range_for_clouds = true;  // clouds are cropped only on request
  if (name == "--classifier" && options.gravity.mode == planes::GravityMode::none)
    throw Error("--classifier " + text +
                " cannot be combined with --gravity none, which labels no points h or v");
}

namespace {

std::array<double, 4> parse_intrinsics(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 4) throw Error("--intrinsics: '" + text + "' is not FX,FY,CX,CY");
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) values[i] = parse_number(parts[i], "--intrinsics");
  if (values[0] <= 0 || values[1] <= 0)
    throw Error("--intrinsics: '" + text +
                "' has a focal length of 0 or less; expected more than 0");
  return values;
}

double parse_depth_unit(const std::string& text) {
  const double unit = parse_number(text, "--depth-unit");
  if (unit <= 0 || unit > 1)
    throw Error("--depth-unit: " + text +
                " is out of range; expected more than 0 and at most 1 meter per count");
  return unit;
}

/// Adds warnings if --gravity or --voxel contradicts the first of the frames to process.
void add_doubts(const planes::PipelineOptions& options, OpenInput& input) {
  const bool doubts_gravity = options.gravity.mode == planes::GravityMode::fixed;
  const bool doubts_voxels = options.cloud.voxel_size_m > planes::CloudOptions().voxel_size_m;
  if (!(doubts_gravity || doubts_voxels) || !input.recording->info().knows_camera()) return;
  const auto add = [&](const std::string& doubt) {
    if (!doubt.empty())
      input.warnings.push_back(
          fmt::format("{}, frame {}: {}", input.path.string(), input.frames.front(), doubt));
  };
  try {
    const Frame frame = input.recording->frame(input.frames.front());
    if (doubts_gravity)
      add(planes::doubt_in_gravity(frame, options.gravity.direction, options.gravity));
    if (doubts_voxels)
      add(planes::doubt_in_voxels(
          planes::make_cloud(frame, planes::unknown_gravity(frame, ""), options.cloud),
          options.cloud.voxel_size_m));
  } catch (const Error&) {
    // Damaged: reported when the frame is used.
  }
}

}  // namespace

void set_input_option(InputArgs& args, const std::string& name, const std::string& text) {
  if (text.empty()) return;
  if (name == "--frames")
    args.frames = parse_frame_slice(text);
  else if (name == "--intrinsics")
    args.recording.intrinsics = parse_intrinsics(text);
  else if (name == "--depth-unit")
    args.recording.depth_unit_m = parse_depth_unit(text);
  else if (name == "--instance-field")
    args.recording.instance_field = text;
  else if (name == "--topic")
    args.recording.topic = text;
  else if (name == "--labels")
    args.label_dir = text;
  else
    set_pipeline_option(args.pipeline, name, text);
}

std::optional<int> OpenInput::label_number(int index) const {
  labels::LabelsOfFrames& found = label_lookup->found;
  std::call_once(label_lookup->once, [&] {
    found = labels::labels_of_frames(label_dir, *recording, frames);
    if (!found.warning.empty()) notice("warning: {}", found.warning);
  });
  const auto at = found.number_of.find(index);
  return at == found.number_of.end() ? std::nullopt : std::optional(at->second);
}

std::optional<planes::SourceTruth> OpenInput::truth(const Frame& frame) const {
  const std::optional<int> number = label_number(frame.index);
  return labels::frame_truth(frame, number ? label_dir : fs::path(),
                             recording->frame_hash(frame.index), number);
}

Frame OpenInput::frame(int index) const {
  return naming_memory(name_of(index), [&] {
    Frame frame = read_frame([&] { return recording->frame(index); });
    if (gravity) gravity->resolve(frame, picked);
    return frame;
  });
}

std::string OpenInput::name_of(int index) const {
  const io::RecordingInfo& info = recording->info();
  return fmt::format("{}, frame {}{}", path.string(), index,
                     info.width > 0 ? fmt::format(" ({}x{})", info.width, info.height) : "");
}

void warn(const InputArgs& args, const std::string& warning) {
  if (args.warnings_as_errors) throw Error(warning);
  notice("warning: {}", warning);
}

std::string no_planes_text(const std::string& recording, std::size_t frames) {
  return fmt::format("{}: 0 planes in {}; are the depth unit, --max-range, and --voxel correct?",
                     recording, counted(frames, "frame"));
}

namespace {

/// Warns about options that differ from the profile's but are not used by this run.
void warn_of_unused_options(const InputArgs& args) {
  const planes::PipelineOptions& options = args.pipeline;
  std::vector<std::string> unused;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.get(options) != planes::default_value(info, options.segment.profile) &&
        (!info.matters(options) || planes::is_idle(info, options)))
      unused.push_back(info.name);
  if (!unused.empty())
    warn(args, fmt::format("{}: no effect with method {} and profile {}; see planescope options {}",
                           fmt::join(unused, ", "), planes::to_string(options.method),
                           planes::to_string(options.segment.profile), unused[0]));
}

}  // namespace

std::vector<OpenInput> open_inputs(const InputArgs& args, const fs::path& out) {
  warn_of_unused_options(args);
  std::vector<fs::path> paths = args.inputs;
  if (paths.empty()) {
    paths.push_back(find_asset("sample", "no recording was specified, and the sample is"));
    notice("no recording specified; using the sample, {}", paths[0].string());
  }
  // Skip label folders, which a glob lists beside their recordings.
  const std::vector<fs::path> given = paths;
  std::erase_if(paths, [&](const fs::path& path) {
    const auto is_label_dir_of = [&](const fs::path& recording) {
      return recording != path && labels::default_label_dir(recording) == path;
    };
    return std::ranges::any_of(given, is_label_dir_of);
  });
  if (args.label_dir && paths.size() > 1)
    throw Error(
        fmt::format("--labels specifies one folder, but there are {} recordings", paths.size()));
  if (args.label_dir && !fs::is_directory(*args.label_dir))
    throw Error(args.label_dir->string() + ": not a label folder");
  std::vector<OpenInput> inputs;
  for (const fs::path& path : paths) {
    check_outside(out, path);
    OpenInput input;
    input.path = path;
    input.recording = io::open_recording(path, args.recording);
    const int count = input.recording->frame_count();
    input.frames = sliced_frames(args.frames, count);
    if (input.frames.empty())
      throw Error(fmt::format("{}: --frames selects none of its {} frames (numbered from 0)",
                              path.string(), count));
    input.label_dir = args.label_dir.value_or(labels::default_label_dir(path));
    if (args.pipeline.gravity.mode == planes::GravityMode::automatic) {
      input.picked = io::read_picked_gravity(input.label_dir, *input.recording);
      input.gravity =
          std::make_shared<world::SequenceGravity>(input.recording, args.pipeline.gravity);
      input.recording = io::with_picked_gravity(std::move(input.recording), input.picked);
    }
    input.warnings = input.recording->info().warnings;
    add_doubts(args.pipeline, input);
    for (const std::string& warning : input.warnings) warn(args, warning);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

DamagedFrames damaged_at_open(const io::Recording& recording, const std::vector<int>& frames) {
  DamagedFrames damaged;
  const std::map<int, std::string>& known = recording.info().damaged;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (const auto found = known.find(frames[i]); found != known.end())
      damaged.add(i, frames[i], Error(found->second));
  return damaged;
}

int leave_out_damaged(std::vector<OpenInput>& inputs) {
  int code = 0;
  for (OpenInput& input : inputs) {
    const DamagedFrames damaged = damaged_at_open(*input.recording, input.frames);
    code = std::max(code, damaged.report(input.frames.size()));
    damaged.remove_from(input.frames);
    if (input.frames.empty()) throw Error(damaged.lines.front());
  }
  return code;
}

bool may_have_truth(const OpenInput& input, int index) {
  const std::map<int, std::string>& damaged = input.recording->info().damaged;
  if (damaged.contains(index)) throw FrameDamaged(damaged.at(index));
  const bool is_cloud = input.recording->info().width == 0;
  return is_cloud || input.label_number(index);
}

bool labels_points(const planes::PipelineOptions& options) {
  return options.method == planes::Method::ours &&
         options.gravity.mode != planes::GravityMode::none;
}

planes::ChosenClassifier choose_classifier(const planes::PipelineOptions& options) {
  if (!labels_points(options)) return {};
  fs::path shipped;
  if (options.classifier == "gcn")
    shipped = find_asset("classifier.safetensors", "the weights of classifier gcn are");
  return planes::make_classifier(options, shipped);
}

LoadedFrame run_input_frame(const OpenInput& input,
                            int index,
                            const planes::PipelineOptions& options,
                            const planes::Classifier* classifier,
                            bool want_truth,
                            planes::Trace* trace) {
  LoadedFrame loaded;
  const auto started = std::chrono::steady_clock::now();
  loaded.frame = input.frame(index);
  const std::chrono::duration<double, std::milli> load = std::chrono::steady_clock::now() - started;

  const bool needs_truth = !classifier && labels_points(options);
  std::optional<planes::FrameTruth> on_points;
  if (needs_truth || want_truth) loaded.truth = input.truth(loaded.frame);
  if (needs_truth && loaded.truth)
    on_points =
        planes::truth_on_points(loaded.truth->values, planes::measured_sources(loaded.frame));
  if (needs_truth && !loaded.truth)
    throw FrameRefused(
        fmt::format("{}, frame {}: classifier truth needs labels; found neither label files in {} "
                    "nor a label field",
                    input.path.string(), index, input.label_dir.string()));
  naming_memory(input.name_of(index), [&] {
    try {
      loaded.result = planes::run_frame(loaded.frame, options, classifier,
                                        on_points ? &*on_points : nullptr, trace);
    } catch (const Error& error) {
      const std::string what = error.what();
      const std::string frame = what.starts_with("frame ") ? "" : fmt::format("frame {}: ", index);
      throw FrameRefused(fmt::format("{}, {}{}", input.path.string(), frame, what));
    }
  });
  loaded.result.timings.load_ms = load.count();
  return loaded;
}

void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read) {
  std::ifstream file = open_to_read(list);
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::istringstream words(line);
    if ((words >> std::ws).eof() || words.peek() == '#') continue;
    try {
      read(words);
    } catch (const Error& error) {
      throw Error(fmt::format("{}, line {}: {}", list.string(), number, error.what()));
    }
  }
  if (file.bad()) throw Error(list.string() + ": cannot be read completely");
}

void set_listed_options(InputArgs& args,
                        std::istringstream& words,
                        std::span<const std::string> known) {
  std::string name, value;
  while (words >> name) {
    if (std::ranges::find(known, name) == known.end())
      throw Error(
          fmt::format("unknown option '{}'; expected one of {}", name, fmt::join(known, ", ")));
    if (!(words >> value)) throw Error(name + " needs a value");
    set_input_option(args, name, value);
  }
}

}  // namespace planescope::app
