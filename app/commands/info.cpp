// planescope info and planescope options.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/commands/commands.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArgs {
  InputArgs input;
  bool json = false;
};

struct Facts {
  io::RecordingInfo info;
  int frame_count = 0;
  int first = 0;  // frame used for the figures below
  DamagedFrames damaged;
  int labeled = 0;
  std::string label_dir;

  // Timestamps, if the frames have them.
  double span_s = 0, median_step_s = 0;
  int gaps = 0;  // steps longer than 1.5 times the median
  double longest_gap_s = 0;
  int longest_gap_frame = 0;  // the frame at the end of the gap

  // Figures for the first frame.
  double measured_percent = 0, within_percent = 0;
  double min_m = 0, median_m = 0, max_m = 0;
  std::uint64_t saturated = 0;  // pixels with a count of 65535
  std::size_t cloud_points = 0;
  bool cloud_has_label = false, cloud_has_instance = false, cloud_has_color = false;
  int color_width = 0, color_height = 0;
  std::optional<Gravity> gravity;
  std::string gravity_error;
};

void measure_times(const OpenInput& input, Facts& facts) {
  std::vector<double> times;
  for (int i = 0; i < facts.frame_count; ++i) times.push_back(input.recording->timestamp_s(i));
  if (times.size() < 2 || times.back() <= times.front()) return;
  facts.span_s = times.back() - times.front();
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  facts.median_step_s = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] <= 1.5 * facts.median_step_s) continue;
    ++facts.gaps;
    if (steps[i] <= facts.longest_gap_s) continue;
    facts.longest_gap_s = steps[i];
    facts.longest_gap_frame = static_cast<int>(i) + 1;
  }
}

void measure_depth(const Frame& frame, double max_range_m, Facts& facts) {
  std::vector<std::uint16_t> counts;
  counts.reserve(frame.depth.pixels());
  std::size_t within = 0;
  for (const std::uint16_t count : frame.depth.data) {
    if (count == 0) continue;
    if (count == 65535) {
      ++facts.saturated;
      continue;
    }
    counts.push_back(count);
    within += count * frame.depth_unit_m <= max_range_m;
  }
  if (counts.empty()) return;
  const auto percent = [&](std::size_t n) {
    return 100.0 * static_cast<double>(n) / static_cast<double>(frame.depth.pixels());
  };
  facts.measured_percent = percent(counts.size());
  facts.within_percent = percent(within);
  std::sort(counts.begin(), counts.end());
  facts.min_m = counts.front() * frame.depth_unit_m;
  facts.median_m = counts[counts.size() / 2] * frame.depth_unit_m;
  facts.max_m = counts.back() * frame.depth_unit_m;
}

/// The first that can be read; those before it are damaged. Throws Error if there is none.
Frame first_frame(const OpenInput& input, DamagedFrames& damaged) {
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    try {
      return input.frame(input.frames[i]);
    } catch (const FrameDamaged& error) {
      if (std::ranges::count(damaged.positions, i) == 0) damaged.add(i, input.frames[i], error);
    }
  }
  throw Error(damaged.lines.front());
}

Facts gather(const OpenInput& input, const planes::PipelineOptions& options) {
  Facts facts;
  facts.info = input.recording->info();
  facts.info.warnings = input.warnings;
  facts.frame_count = input.recording->frame_count();
  facts.damaged = damaged_at_open(*input.recording, input.frames);
  const Frame frame = first_frame(input, facts.damaged);
  facts.first = frame.index;
  measure_times(input, facts);
  if (frame.is_cloud()) {
    facts.cloud_points = frame.cloud->points.size();
    facts.cloud_has_label = !frame.cloud->label.empty();
    facts.cloud_has_instance = !frame.cloud->instance.empty();
    facts.cloud_has_color = !frame.cloud->rgb.empty();
  } else {
    measure_depth(frame, options.cloud.max_range_m, facts);
  }
  facts.color_width = frame.color.width;
  facts.color_height = frame.color.height;
  if (!facts.info.knows_camera())
    facts.gravity_error = "the scene cannot be measured without intrinsics";
  else
    try {
      facts.gravity = planes::resolve_gravity(frame, options.gravity, options.cloud.max_range_m);
    } catch (const Error& error) {
      facts.gravity_error = error.what();
    }
  facts.label_dir = input.label_dir.string();
  if (facts.info.width > 0) {
    const labels::LabelsOfFrames found =
        labels::labels_of_frames(input.label_dir, *input.recording, {});
    if (!found.warning.empty()) {
      notice("warning: {}", found.warning);
      facts.info.warnings.push_back(found.warning);
    }
    for (const auto& [index, number] : found.number_of)
      facts.labeled += index < facts.frame_count &&
                       labels::is_there(labels::label_file_paths(input.label_dir, number)[0]);
  }
  return facts;
}

Json intrinsics_json(const Intrinsics& k) {
  Json json = {{"width", k.width}, {"height", k.height}, {"fx", k.fx},
               {"fy", k.fy},       {"cx", k.cx},         {"cy", k.cy}};
  json["distortion"] = to_string(k.distortion);
  if (k.distortion != Distortion::none) json["coefficients"] = k.coefficients;
  return json;
}

Json to_json(const Facts& f) {
  Json json;
  json["path"] = f.info.path.string();
  json["format"] = f.info.format;
  json["device"] = f.info.device;
  json["frames"] = f.frame_count;
  if (!f.info.topics.empty()) json["topics"] = f.info.topics;
  if (f.info.width > 0) {
    json["depth"] = {{"width", f.info.width},
                     {"height", f.info.height},
                     {"unit_m", f.info.depth_unit_m},
                     {"unit_source", f.info.depth_unit_source}};
    json["intrinsics"] = nullptr;
    if (f.info.knows_camera()) {
      json["intrinsics"] = intrinsics_json(f.info.intrinsics);
      json["intrinsics"]["source"] = f.info.intrinsics_source;
    }
    json["ignored_calibration"] = f.info.ignored_calibration;
    json["color"] = nullptr;
    if (f.info.has_color)
      json["color"] = {
          {"width", f.color_width}, {"height", f.color_height}, {"note", f.info.color_note}};
  } else {
    json["cloud"] = {{"points", f.cloud_points},
                     {"color", f.cloud_has_color},
                     {"label", f.cloud_has_label},
                     {"instance", f.cloud_has_instance}};
  }
  json["time"] = nullptr;
  if (f.span_s > 0)
    json["time"] = {{"span_s", f.span_s},
                    {"median_step_s", f.median_step_s},
                    {"gaps", f.gaps},
                    {"longest_gap_s", f.longest_gap_s},
                    {"source", f.info.times_source}};
  json["gravity"] = nullptr;
  if (f.gravity) {
    const Vec3d& d = f.gravity->direction;
    json["gravity"] = {{"direction", nullptr},
                       {"source", to_string(f.gravity->source)},
                       {"confidence", f.gravity->confidence},
                       {"note", f.gravity->note}};
    if (f.gravity->known()) json["gravity"]["direction"] = {d.x(), d.y(), d.z()};
  } else {
    json["gravity_error"] = f.gravity_error;
  }
  json["first_frame"] = {{"index", f.first}};
  if (f.info.width > 0) {
    json["first_frame"]["measured_percent"] = f.measured_percent;
    json["first_frame"]["within_max_range_percent"] = f.within_percent;
    json["first_frame"]["depth_m"] = {{"min", f.min_m}, {"median", f.median_m}, {"max", f.max_m}};
    json["first_frame"]["counts_65535"] = f.saturated;
  }
  json["labels"] = {{"folder", f.label_dir}, {"frames", f.labeled}};
  json["warnings"] = f.info.warnings;
  json["damaged"] = f.damaged.lines;
  return json;
}

void line(const std::string& name, const std::string& text) {
  fmt::print("  {:<12}{}\n", name, one_line(text));  // device and topic names come from the file
}

void print_depth(const Facts& f, double max_range_m) {
  const Intrinsics& k = f.info.intrinsics;
  line("depth", fmt::format("{}x{}, 1 unit = {:.6g} mm, {}", f.info.width, f.info.height,
                            f.info.depth_unit_m * 1000, f.info.depth_unit_source));
  std::string distortion = "no distortion";
  if (k.distortion != Distortion::none)
    distortion = fmt::format(
        "{} {:.5g}",
        k.distortion == Distortion::brown_conrady ? "Brown-Conrady" : "inverse Brown-Conrady",
        fmt::join(k.coefficients, " "));
  line("intrinsics", f.info.knows_camera()
                         ? fmt::format("fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}, {}, {}", k.fx,
                                       k.fy, k.cx, k.cy, distortion, f.info.intrinsics_source)
                         : std::string("unknown; ") + io::kHowToGiveIntrinsics);
  if (!f.info.ignored_calibration.empty())
    line("ignored",
         fmt::format("{}: {}", fmt::join(f.info.ignored_calibration, ", "), io::kNotACalibration));
  line("color", f.info.has_color
                    ? fmt::format("{}x{}, {}", f.color_width, f.color_height, f.info.color_note)
                    : "none");
  line(fmt::format("frame {}", f.first),
       fmt::format("{:.1f} % of pixels measured, {:.2f} to {:.2f} m, median {:.2f} m; {:.1f} % "
                   "within {:.6g} m{}",
                   f.measured_percent, f.min_m, f.max_m, f.median_m, f.within_percent, max_range_m,
                   f.saturated > 0 ? fmt::format("; {} counts of 65535", f.saturated) : ""));
}

void print_cloud(const Facts& f) {
  std::string fields = "x y z";
  if (f.cloud_has_color) fields += ", color";
  if (f.cloud_has_label) fields += ", label";
  if (f.cloud_has_instance) fields += ", instance";
  line(fmt::format("frame {}", f.first), fmt::format("{} points: {}", f.cloud_points, fields));
}

void print_text(const Facts& f, double max_range_m) {
  fmt::print("{}\n", one_line(f.info.path.string()));
  line("format", f.info.format);
  if (!f.info.device.empty()) line("device", f.info.device);
  line("frames", f.damaged.lines.empty()
                     ? std::to_string(f.frame_count)
                     : fmt::format("{}, {} damaged", f.frame_count, f.damaged.lines.size()));
  if (!f.info.topics.empty()) {
    std::string others =
        fmt::format("{}", fmt::join(f.info.topics, ", ")).substr(f.info.topics[0].size());
    line("topic", f.info.topics[0] + (others.empty() ? "" : "; others" + others.substr(1)));
  }
  if (f.info.width > 0)
    print_depth(f, max_range_m);
  else
    print_cloud(f);
  if (f.span_s > 0) {
    const std::string gaps =
        f.gaps == 0 ? "no gaps"
                    : fmt::format("{} gap{}, the longest {:.3f} s before frame {}", f.gaps,
                                  f.gaps == 1 ? "" : "s", f.longest_gap_s, f.longest_gap_frame);
    const std::string rate = f.median_step_s > 0
                                 ? fmt::format("{:.2f} frames per second", 1 / f.median_step_s)
                                 : "most frames have the same time";
    line("time",
         fmt::format("{:.3f} s, {}, {}, from {}", f.span_s, rate, gaps, f.info.times_source));
  } else if (f.frame_count > 1) {
    line("time", f.info.times_source.empty() ? std::string("the frames have no timestamps")
                                             : "does not increase, from " + f.info.times_source);
  }
  if (f.gravity && !f.gravity->known()) {
    line("gravity", fmt::format("none, {}: planes are neither h nor v; to distinguish them, {}",
                                f.gravity->note, planes::kHowToGiveGravity));
  } else if (f.gravity) {
    const Gravity& g = *f.gravity;
    std::string how = to_string(g.source);
    if (g.note.starts_with(how))
      how = g.note;
    else if (!g.note.empty())
      how += ", " + g.note;
    if (g.confidence < 1) how += fmt::format("; confidence {:.2f}", g.confidence);
    // + 0.0 avoids -0.
    line("gravity", fmt::format("{:.4f},{:.4f},{:.4f} ({})", g.direction.x() + 0.0,
                                g.direction.y() + 0.0, g.direction.z() + 0.0, how));
  } else {
    line("gravity", "unknown: " + f.gravity_error);
  }
  if (f.labeled > 0)
    line("labels", fmt::format("{} of {} frames, {}", f.labeled, f.frame_count, f.label_dir));
}

/// Prints the contents of each recording: format, device, sizes, unit, intrinsics, color, gravity,
/// timestamps and gaps, and lost data. Returns the exit code.
int run_info(const InfoArgs& args, std::stop_token) {
  Json json;
  json["schema"] = "planescope.info/1";
  json["recordings"] = Json::array();
  InputArgs input_args = args.input;
  input_args.recording.intrinsics_may_lack = true;
  input_args.recording.standard_input = true;
  int code = 0;
  for (const OpenInput& input : open_inputs(input_args)) {
    const Facts facts = gather(input, args.input.pipeline);
    code = std::max(code, facts.damaged.report(input.frames.size()));
    if (args.json)
      json["recordings"].push_back(to_json(facts));
    else
      print_text(facts, args.input.pipeline.cloud.max_range_m);
  }
  if (args.json) fmt::print("{}", json_text(json, 2));
  return code;
}

}  // namespace

void define_info(CLI::App& app, Line& line) {
  CLI::App* info = app.add_subcommand(
      "info", "Show what a recording contains: sizes, unit, intrinsics, gravity, time, gaps");
  const auto args = std::make_shared<InfoArgs>();
  add_recordings(info, args->input, true);
  add_json(info, args->json);
  add_method(info, args->input.pipeline);
  runs(info, line, args, run_info);
}

namespace {

struct OptionsArgs {
  std::string name;                  // option to explain; empty: all
  planes::PipelineOptions pipeline;  // values to show
  bool json = false;
};

constexpr planes::Profile kProfiles[] = {planes::Profile::refined, planes::Profile::paper,
                                         planes::Profile::paper_closest};

Json to_json(const planes::OptionInfo& info, const planes::PipelineOptions& options) {
  Json json = {{"name", info.name},       {"value", info.get(options)}, {"unit", info.unit},
               {"section", info.section}, {"meaning", info.meaning},    {"min", nullptr},
               {"max", nullptr},          {"choices", info.choices}};
  if (info.is_number()) json["min"] = info.range.min;
  if (info.is_number() && !std::isinf(info.range.max)) json["max"] = info.range.max;
  for (const planes::Profile profile : kProfiles)
    json["defaults"][planes::to_string(profile)] = planes::default_value(info, profile);
  return json;
}

std::string range_text(const planes::OptionInfo& info) {
  if (info.kind == planes::OptionKind::on_off) return "on or off";
  if (!info.is_number()) return fmt::format("{}", fmt::join(split(info.unit, '/'), ", "));
  const planes::OptionRange& range = info.range;
  const std::string least =
      fmt::format("{} {}", range.min_excluded ? "more than" : "at least", range.min);
  return (info.kind == planes::OptionKind::whole ? "whole number, " : "") + least +
         (std::isinf(range.max) ? "" : fmt::format(" and at most {}", range.max));
}

/// Prints all details of one option.
void print_option(const planes::OptionInfo& info, const planes::PipelineOptions& options) {
  const bool has_unit = info.is_number() && info.unit != "1";
  fmt::print("{}: {}\n", info.name, info.meaning);
  line("value", info.get(options) + (has_unit ? " " + info.unit : ""));
  std::string defaults;
  for (const planes::Profile profile : kProfiles)
    defaults += fmt::format("{}{} ({})", defaults.empty() ? "" : ", ",
                            planes::default_value(info, profile), planes::to_string(profile));
  line("default", defaults);
  line("range", range_text(info));
  line("stage", info.section);
  if (info.method) line("method", planes::to_string(*info.method));
  if (info.objective) line("profile", *info.objective ? "refined" : "paper, paper-closest");
  if (!info.symbol.empty()) line("paper", info.symbol);
  line("JSON key",
       fmt::format("options.{} in planes.json{}", info.name,
                   info.name == "profile" ? "; base in profile files" : " and profile files"));
  line("example", fmt::format("--set {}={}", info.name, info.get(options)));
}

void print_table(const planes::PipelineOptions& options) {
  std::size_t name_width = 0, value_width = 0;
  for (const planes::OptionInfo& info : planes::option_table()) {
    name_width = std::max(name_width, info.name.size());
    value_width = std::max(value_width, info.get(options).size());
  }
  fmt::print("Values of profile {}. Set one with --set NAME=VALUE.\n",
             planes::to_string(options.segment.profile));
  std::string section;
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (info.section != section) fmt::print("\n{}\n", info.section);
    section = info.section;
    fmt::print("  {:<{}}  {:>{}}  {} [{}]\n", info.name, name_width, info.get(options), value_width,
               info.meaning, info.unit);
  }
}

/// Prints one option, or all that --set supports. Returns the exit code.
int run_options(const OptionsArgs& args, std::stop_token) {
  if (!args.json && args.name.empty()) {
    print_table(args.pipeline);
  } else if (!args.json) {
    print_option(planes::find_option(args.name), args.pipeline);
  } else {
    Json json = {{"schema", "planescope.options/1"}, {"options", Json::array()}};
    if (!args.name.empty()) planes::find_option(args.name);  // throws for an unknown one
    for (const planes::OptionInfo& info : planes::option_table())
      if (args.name.empty() || info.name == args.name)
        json["options"].push_back(to_json(info, args.pipeline));
    fmt::print("{}", json_text(json, 2));
  }
  return 0;
}

}  // namespace

void define_options(CLI::App& app, Line& line) {
  CLI::App* options = app.add_subcommand(
      "options", "List the options of the method with their values, or explain one of them");
  const auto args = std::make_shared<OptionsArgs>();
  add(options, "NAME", args->name, "", "Option to explain (default: list all)");
  add_json(options, args->json);
  add_method(options, args->pipeline);
  runs(options, line, args, run_options);
}

}  // namespace planescope::app
