#include "app/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "app/commands/eval.hpp"
#include "app/commands/info.hpp"
#include "app/commands/options.hpp"
#include "app/commands/report.hpp"
#include "app/commands/segment.hpp"
#include "app/commands/synth.hpp"
#include "app/typed.hpp"
#include "core/base/error.hpp"
#include "core/base/text.hpp"

namespace planescope {
namespace {

// CLI11 prints descriptions as they are: broken here, so that they fit beside the names.
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

CLI::Option* add(CLI::App* command,
                 const std::string& names,
                 std::string& value,
                 const std::string& type,
                 const std::string& help) {
  return command->add_option(names, value, wrapped(help))->type_name(type);
}

void add_inputs(CLI::App* command, Typed& t, const std::string& what) {
  command->add_option("INPUT", t.inputs, what)->type_name("");
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(command, name, value, type, help)->group("Recordings");
  };
  option("--frames", t.frames, "A:B:STEP",
         "Which frames, as Python slices a list: 0:100:10, -5:, or 7");
  option("--intrinsics", t.intrinsics, "FX,FY,CX,CY",
         "Of the depth image, in pixels; wins over what the files say");
  option("--depth-unit", t.depth_unit, "METRES",
         "Metres per depth count; wins over what the files say");
  option("--labels", t.labels, "DIR", "Ground truth; otherwise <recording>.labels beside it");
}

void add_method(CLI::App* command, Typed& t) {
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(command, name, value, type, help)->group("Method");
  };
  option("--profile", t.profile, "paper|paper-closest|refined",
         "Where the options' values come from; default refined");
  command
      ->add_option("--set", t.set,
                   wrapped("Any option by its name, after the profile; `planescope options` lists "
                           "them. May be given many times"))
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Method");
  option("--gravity", t.gravity, "auto|X,Y,Z|imu|estimate",
         "Direction in which things fall, in the sensor's own frame (x right, y down, z forward; "
         "clouds: the file's axes). auto, the default, takes the first that exists: the "
         "recording's own, its IMU, an estimate from the scene");
  option("--max-range", t.max_range, "M",
         "Crop what is farther: depth z of depth frames (default 1.5), distance from the origin of "
         "clouds (default none)");
  option("--voxel", t.voxel, "M", "Edge of the voxel grid, default 0.02; 0 = none");
  option("--classifier", t.classifier, "pca|truth", "What labels points h or v; default pca");
  option("--method", t.method, "ours", "What finds the planes");
  option("--threads", t.threads, "N",
         "Default: all cores. The results are the same for any number");
}

void add_json(CLI::App* command, Typed& t) {
  command->add_flag("--json", t.json, "Print JSON instead of text");
}

void add_out(CLI::App* command, Typed& t) {
  add(command, "-o,--out", t.out, "DIR", "Output folder; made where it is missing");
}

// The command that was typed last: `synth stairs` is the app of `stairs`.
const CLI::App* innermost(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

// One line for what CLI11 did not understand, with the name that was probably meant.
std::string message_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = innermost(&app);
  const std::vector<std::string> extras = app.remaining(true);
  if (extras.empty()) {
    std::string text = error.what();
    return text.substr(0, text.find('\n'));
  }
  const std::string& word = extras.front();
  const bool is_option = word.size() > 1 && word[0] == '-';
  std::vector<std::string> names;
  if (is_option) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  } else {
    for (const CLI::App* sub : command->get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(sub->get_name());
  }
  const std::string given = word.substr(0, word.find('='));
  const std::string near = nearest_name(given, names);
  std::string text = is_option       ? "unknown option '" + given + "'"
                     : names.empty() ? "unexpected argument '" + given + "'"
                                     : "unknown command '" + given + "'";
  if (!near.empty()) return text + ", did you mean '" + near + "'?";
  const std::string name = command == &app ? "" : " " + command->get_name();
  return text + ", see planescope" + name + " --help";
}

}  // namespace

Job parse_command_line(int argc, char** argv) {
  const auto typed = std::make_shared<Typed>();
  Typed& t = *typed;
  CLI::App app(
      "planescope finds planes in depth recordings and point clouds, after Sun et al. 2023, "
      "\"Multi-Resolution Planar Region Extraction\".\n"
      "A command that is given no recording takes the sample that comes with it.",
      "planescope");
  app.set_version_flag("--version", "planescope " PLANESCOPE_VERSION);
  app.get_formatter()->column_width(34);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  Job job;

  CLI::App* info = app.add_subcommand(
      "info", "What is in a recording: sizes, unit, intrinsics, gravity, time and gaps");
  add_inputs(info, t, "Bags, folders, .raw, .ply or .pcd files");
  add_json(info, t);
  add_method(info, t);
  info->final_callback([&job, typed] {
    job = [args = InfoArgs{input_args(*typed), typed->json}](std::stop_token) {
      return run_info(args);
    };
  });

  CLI::App* segment = app.add_subcommand(
      "segment",
      "Find the planes of each frame: planes.json, planes.png, cloud.ply, timings.json.\n"
      "Planes and cloud.ply are in the world frame: z up, metres.");
  add_inputs(segment, t, "One bag, folder, .raw, .ply or .pcd file");
  add_out(segment, t);
  add_json(segment, t);
  add_method(segment, t);
  segment->final_callback([&job, typed] {
    job = [args = SegmentArgs{input_args(*typed), required_out(*typed, "segment"), typed->json}](
              std::stop_token stop) { return run_segment(args, stop); };
  });

#ifdef PLANESCOPE_WITH_REPORT
  CLI::App* report = app.add_subcommand(
      "report", "Write a report that opens in a browser: index.html, report.json, pictures");
  add_inputs(report, t, "Bags, folders, .raw, .ply or .pcd files");
  add_out(report, t);
  add_json(report, t);
  add_method(report, t);
  report->final_callback([&job, typed, command = command_text(argc, argv)] {
    job = [args = ReportArgs{input_args(*typed), required_out(*typed, "report"), typed->json,
                             command}](std::stop_token stop) { return run_report(args, stop); };
  });

#endif

  CLI::App* eval =
      app.add_subcommand("eval", "Metrics against ground truth: label files, or a cloud's fields");
  add_inputs(eval, t, "Bags, folders, .raw, .ply or .pcd files");
  add_json(eval, t);
  add_method(eval, t);
  eval->final_callback([&job, typed] {
    job = [args = EvalArgs{input_args(*typed), typed->json}](std::stop_token stop) {
      return run_eval(args, stop);
    };
  });

  CLI::App* options = app.add_subcommand(
      "options", "List every option that --set takes, with value, unit and meaning");
  add_json(options, t);
  add_method(options, t);
  options->final_callback([&job, typed] {
    job = [args = OptionsArgs{pipeline_options(*typed), typed->json}](std::stop_token) {
      return run_options(args);
    };
  });

  CLI::App* synth = app.add_subcommand("synth", "Write synthetic recordings with ground truth");
  CLI::App* stairs = synth->add_subcommand(
      "stairs", "The paper's evaluation set: stairs as PLY clouds with label and instance");
  add_out(stairs, t);
  add(stairs, "--count", t.count, "N", "How many stairs, default 100");
  add(stairs, "--points", t.points, "N", "Points of each, default 8192; 0 = dense sampling");
  add(stairs, "--noise", t.noise, "M", "Standard deviation of the noise, default 0");
  add(stairs, "--seed", t.seed, "N", "Another seed makes another set, default 1");
  stairs->add_flag("--axis-aligned", t.axis_aligned, "Do not turn the stairs about z");
  add(stairs, "--threads", t.threads, "N", "Default: all cores");
  stairs->final_callback([&job, typed] {
    job = [args = stairs_args(*typed)](std::stop_token stop) {
      return run_synth_stairs(args, stop);
    };
  });

  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    command->group("Commands");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream text;
    app.exit(success, text, text);
    return [text = text.str()](std::stop_token) {
      fmt::print("{}", text);
      return 0;
    };
  } catch (const CLI::ParseError& error) {
    throw Error(message_of(app, error));
  }
  if (!job) {
    const CLI::App* command = innermost(&app);
    if (command != &app) throw Error(command->get_name() + " needs one of: sample, stairs");
    return [text = app.help()](std::stop_token) {
      fmt::print("{}", text);
      return 0;
    };
  }
  return job;
}

}  // namespace planescope
