// Shared command-line options, bound to CLI11 with validation and help text.

#include "app/cli/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

/// Says what is wrong with a text, empty where nothing is. A good one is written plainly: CLI11
/// would read 010 as 8.
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
             ? fmt::format("{} is out of range, expected {} to {}", text, least, most)
             : fmt::format("{} is out of range, expected at least {}", text, least);
}

constexpr const char* kReadLimitHelp =
    "What one image, chunk or table of a file may take in memory, default 512; more is refused";

}  // namespace

std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 62;
  std::string out;
  std::size_t column = 0;
  std::istringstream words(text);
  for (std::string word; words >> word; column += word.size() + 1) {
    if (column > 0 && column + word.size() > kWidth) {
      out += '\n';
      column = 0;
    } else if (column > 0) {
      out += ' ';
    }
    out += word;
  }
  return out;
}

CLI::Option* add_read(CLI::App* command,
                      const std::string& names,
                      const std::function<void(const std::string&)>& read,
                      const std::string& type,
                      const std::string& help) {
  return command->add_option_function<std::string>(names, read, wrapped(help))->type_name(type);
}

CLI::Validator whole(int least, int most) {
  return {[=](std::string& text) { return refusal(text, "whole number", least, most); }, ""};
}

CLI::Validator number(double least, double most) {
  return {[=](std::string& text) { return refusal(text, "number", least, most); }, ""};
}

CLI::Validator some_of(const std::vector<std::string>& known, const std::string& what) {
  return {[=](std::string& text) -> std::string {
            if (std::ranges::find(known, text) != known.end()) return {};
            return fmt::format("'{}' is not {}, expected some of {}", text, what,
                               fmt::join(known, ", "));
          },
          ""};
}

void add_inputs(CLI::App* command, InputArgs& args, const std::string& what) {
  command->add_option("INPUT", args.inputs, what)->type_name("");
  const auto option = [&](const char* name, const char* type, const char* help) {
    const auto read = [&args, name](const std::string& text) {
      set_input_option(args, name, text);
    };
    add_read(command, name, read, type, help)->group("Recordings");
  };
  option("--frames", "A:B:STEP", "Which frames, as Python slices a list: 0:100:10, -5:, or 7");
  option("--intrinsics", "FX,FY,CX,CY",
         "Of the depth image, in pixels; wins over what the files say");
  option("--depth-unit", "METRES", "Metres per depth count; wins over what the files say");
  option("--topic", "NAME",
         "Bags: topic with the depth images or point clouds to read; `planescope info` lists them");
  option("--instance-field", "NAME",
         "Of clouds: the field with true plane ids, whole numbers from 1, instead of `instance`");
  option("--labels", "DIR", "Ground truth; otherwise <recording>.labels beside it");
  const auto limit = [](int mib) { set_read_limit_bytes(std::uint64_t(mib) << 20); };
  command->add_option_function<int>("--read-limit", limit, wrapped(kReadLimitHelp))
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
                "Where the options' values come from; default refined. FILE: see File formats in "
                "the documents");
  command
      ->add_option_function<std::vector<std::string>>(
          "--set",
          [&options](const std::vector<std::string>& assignments) {
            for (const std::string& assignment : assignments)
              set_pipeline_option(options, "--set", assignment);
          },
          wrapped("Any option by its name, after the profile; `planescope options` lists them. May "
                  "be given many times"))
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Method");
  add_of_method(
      command, options, "--gravity", "auto|X,Y,Z|imu|estimate|none",
      "Direction in which things fall, in the sensor's own frame (x right, y down, z "
      "forward; clouds: the file's axes). auto, the default, takes the first that exists: "
      "the recording's own, its IMU, a floor that was picked in the window, an estimate "
      "from the scene, that of the frames around it. none finds planes of any direction without "
      "telling h from v");
  add_of_method(command, options, "--max-range", "M",
                "Crop what is farther: depth z of depth frames (default 1.5), distance from the "
                "origin of clouds (default none)");
  add_of_method(command, options, "--voxel", "M", "Edge of the voxel grid, default 0.02; 0 = none");
  add_threads(command, options.threads)->group("Method");
}

void add_method(CLI::App* command, planes::PipelineOptions& options) {
  add_clouds(command, options);
  add_of_method(command, options, "--classifier", "gcn|pca|truth|FILE",
                "What labels points h or v: the network that comes with planescope (default), PCA "
                "normals, ground truth, or a network of your own (.safetensors)");
  std::string methods;
  for (const planes::Method method : planes::built_methods())
    methods += method == planes::Method::ours ? "ours (default)"
                                              : std::string(", ") + planes::to_string(method);
  add_of_method(command, options, "--method", "NAME", "What finds the planes: " + methods);
}

void add_foot(CLI::App* command, planes::PipelineOptions& options) {
  add_of_method(command, options, "--foot", "RADIUS|LENGTHxWIDTH",
                "Of a foot, wheel or gripper, in metres: tells where its centre may go, whichever "
                "way it is turned, and which planes are steppable");
}

CLI::Option* add_threads(CLI::App* command, int& threads) {
  return add(command, "--threads", threads, "N",
             "Default: all cores. The results are the same for any number")
      ->transform(whole(1, 1024));
}

void add_json(CLI::App* command, bool& json) {
  command->add_flag("--json", json, "Print JSON instead of text");
}

CLI::Option* add_out(CLI::App* command, std::filesystem::path& out) {
  return add(command, "-o,--out", out, "DIR", "Output folder; made where it is missing");
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
      throw Error(fmt::format("--size: {} is out of range, expected {}x{} to {}x{}", text,
                              least_width, least_height, kMost, kMost));
  };
  add_read(command, "--size", read, "WxH", help);
}

void expect_ours(const planes::PipelineOptions& options, const char* command) {
  if (options.method != planes::Method::ours)
    throw Error(fmt::format("{} measures method ours, found {}", command,
                            planes::to_string(options.method)));
}

void expect_gravity(const planes::PipelineOptions& options, const char* command) {
  if (options.gravity.mode == planes::GravityMode::none)
    throw Error(fmt::format("{} is about h and v, which --gravity none leaves open", command));
}

}  // namespace planescope::app
