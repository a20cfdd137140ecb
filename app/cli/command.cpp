// Shared command-line options, bound to CLI11 with validation and help text.

#include "app/cli/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

/// Describes the error in `text`; empty if it is valid. A valid number is rewritten in plain
/// decimal, because CLI11 would read 010 as octal 8.
template <typename Value>
std::string refusal(std::string& text, const char* kind, Value least, Value most) {
  Value value{};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(static_cast<double>(value)))
    return fmt::format("'{}' is not a {}", text, kind);
  if (value >= least && value <= most) {
    text = fmt::format("{}", value);
    return {};
  }
  return most < std::numeric_limits<Value>::max()
             ? fmt::format("{} is out of range; expected {} to {}", text, least, most)
             : fmt::format("{} is out of range; expected at least {}", text, least);
}

constexpr const char* kReadLimitHelp =
    "Memory limit for one image, chunk, or table of a file (default 512); larger ones are rejected";

}  // namespace

CLI::Option* add_read(CLI::App* command,
                      const std::string& names,
                      const std::function<void(const std::string&)>& read,
                      const std::string& type,
                      const std::string& help) {
  return command->add_option_function<std::string>(names, read, help)->type_name(type);
}

CLI::Validator whole(int least, int most) {
  return {[=](std::string& text) { return refusal(text, "whole number", least, most); }, ""};
}

CLI::Validator number(double least, double most) {
  return {[=](std::string& text) { return refusal(text, "number", least, most); }, ""};
}

std::string clause_of(const std::string& help) {
  std::string clause = help.substr(0, help.find_first_of(";\n"));
  const std::string small = lower_case(clause);
  if (clause.size() > 1 && clause[1] == small[1]) clause[0] = small[0];
  return clause;
}

CLI::Validator some_of(const std::vector<std::string>& known, const std::string& what) {
  return {[=](std::string& text) -> std::string {
            if (std::ranges::find(known, text) != known.end()) return {};
            return fmt::format("'{}' is not {}; expected one of {}", text, what,
                               fmt::join(known, ", "));
          },
          ""};
}

void add_recordings(CLI::App* command, InputArgs& args, bool many, bool clouds) {
  add_inputs(command, args, io::recordings_text(many, clouds) + "; default: the sample recording");
}

void add_inputs(CLI::App* command, InputArgs& args, const std::string& what) {
  command->add_option("INPUT", args.inputs, what)->type_name("");
  const auto option = [&](const char* name, const char* type, const char* help) {
    const auto read = [&args, name](const std::string& text) {
      set_input_option(args, name, text);
    };
    add_read(command, name, read, type, help)->group("Recordings");
  };
  option("--frames", "A:B:STEP",
         "Frames to process (Python slice): 0:100:10, -5:, or 7 for one frame");
  option("--intrinsics", "FX,FY,CX,CY",
         "Depth camera intrinsics in pixels; override the recording's");
  option("--depth-unit", "METERS", "Meters per depth count; overrides the recording's");
  option("--topic", "NAME", "Bag topic to read: depth images or point clouds (info lists them)");
  option("--instance-field", "NAME",
         "Cloud field that contains true plane ids, whole numbers from 1 (default instance)");
  option("--labels", "DIR", "Ground truth (default RECORDING.labels, next to the recording)");
  command
      ->add_flag("--warnings-as-errors", args.warnings_as_errors,
                 "Treat warnings about a recording as errors (exit code 2)")
      ->group("Recordings");
  const auto limit = [](int mib) { set_read_limit_bytes(std::uint64_t(mib) << 20); };
  command->add_option_function<int>("--read-limit", limit, kReadLimitHelp)
      ->type_name("MIB")
      ->transform(whole(1))
      ->group("Recordings");
}

CLI::Option* add_of_method(CLI::App* command,
                           planes::PipelineOptions& options,
                           const char* name,
                           const std::string& type,
                           const std::string& help) {
  const auto read = [&options, name](const std::string& text) {
    set_pipeline_option(options, name, text);
  };
  return add_read(command, name, read, type, help)->group("Method");
}

void add_clouds(CLI::App* command, planes::PipelineOptions& options) {
  add_of_method(command, options, "--profile", "paper|paper-closest|refined|FILE",
                "Profile that sets the option values: a built-in one (default refined) or a file "
                "(docs/formats.md)");
  command
      ->add_option_function<std::vector<std::string>>(
          "--set",
          [&options](const std::vector<std::string>& assignments) {
            for (const std::string& assignment : assignments)
              set_pipeline_option(options, "--set", assignment);
          },
          "Set an option, overriding the profile; repeatable. `planescope options` lists all "
          "options")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Method");
  add_of_method(
      command, options, "--gravity", "auto|X,Y,Z|imu|estimate|none",
      "Gravity direction in the sensor's frame (x right, y down, z forward; clouds: the file's "
      "axes). auto (default) uses the first available: the recording's own, its IMU, a floor "
      "picked in the window, an estimate from the scene, gravity of neighboring frames. none finds "
      "planes without distinguishing horizontal (h) from vertical (v)");
  add_of_method(command, options, "--max-range", "M",
                "Maximum range in meters: depth z for depth images (default 1.5), distance from "
                "the origin for clouds (default unlimited)");
  add_of_method(command, options, "--voxel", "M",
                "Voxel edge in meters (default 0.02); 0 makes every point a voxel");
  add_threads(command, options.threads)->group("Method");
}

void add_method(CLI::App* command, planes::PipelineOptions& options) {
  add_clouds(command, options);
  add_of_method(command, options, "--classifier", "gcn|pca|truth|FILE",
                "Classifier that labels points h or v: the built-in network (gcn, default), PCA "
                "normals, ground truth, or a .safetensors file with a different network");
  std::string methods;
  for (const planes::Method method : planes::built_methods())
    methods += method == planes::Method::ours ? "ours (default)"
                                              : std::string(", ") + planes::to_string(method);
  add_of_method(command, options, "--method", "NAME", "Method that finds planes: " + methods);
}

void add_foot(CLI::App* command, planes::PipelineOptions& options) {
  add_of_method(command, options, "--foot", "RADIUS|LENGTHxWIDTH",
                "Size of a foot, wheel, or gripper in meters: report footholds, valid for any "
                "heading, and steppable planes");
}

CLI::Option* add_threads(CLI::App* command, int& threads) {
  return add(command, "--threads", threads, "N",
             "Number of threads (default all cores); results do not depend on it")
      ->transform(whole(1, 1024));
}

void add_json(CLI::App* command, bool& json) {
  command->add_flag("--json", json, "Print JSON instead of text");
}

CLI::Option* add_out(CLI::App* command, std::filesystem::path& out) {
  return add(command, "-o,--out", out, "DIR", "Output folder; created if missing");
}

CLI::Option* add_planes_out(CLI::App* command, std::filesystem::path& out) {
  return add(command, "-o,--out", out, kPlanesOut,
             std::string(kPlanesOutHelp) + "; created if missing");
}

void add_size(CLI::App* command,
              int& width,
              int& height,
              const std::string& help,
              int least_width,
              int least_height) {
  const auto read = [=, &width, &height](const std::string& text) {
    constexpr int kMost = 8192;
    const std::vector<std::string> sides = split(text, 'x');
    if (sides.size() != 2) throw Error("--size: '" + text + "' is not WxH");
    width = parse_integer(sides[0], "--size");
    height = parse_integer(sides[1], "--size");
    if (width < least_width || height < least_height || width > kMost || height > kMost)
      throw Error(fmt::format("--size: {} is out of range; expected {}x{} to {}x{}", text,
                              least_width, least_height, kMost, kMost));
  };
  add_read(command, "--size", read, "WxH", help);
}

void expect_ours(const planes::PipelineOptions& options, const char* command) {
  if (options.method != planes::Method::ours)
    throw Error(fmt::format("{} supports only method ours, not {}", command,
                            planes::to_string(options.method)));
}

void expect_gravity(const planes::PipelineOptions& options, const char* command) {
  if (options.gravity.mode == planes::GravityMode::none)
    throw Error(fmt::format(
        "{} requires h and v labels, so it cannot be combined with --gravity none", command));
}

}  // namespace planescope::app
