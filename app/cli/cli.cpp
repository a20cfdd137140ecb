#include "app/cli/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "app/cli/cli_parts.hpp"
#include "app/cli/typed.hpp"
#include "app/commands/eval.hpp"
#include "app/commands/info.hpp"
#include "app/commands/options.hpp"
#include "app/commands/report.hpp"
#include "app/commands/segment.hpp"
#include "app/commands/view.hpp"
#include "app/lab/bench_classifier.hpp"
#include "app/lab/bench_desktop.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

// The command line while it is read. A command's callback makes the job from what was typed.
struct Line {
  CLI::App app{
      "planescope finds planes in depth recordings and point clouds, after Sun et al. 2023,\n"
      "\"Multi-Resolution Planar Region Extraction\".\n"
      "A command that is given no recording takes the sample that comes with it.",
      "planescope"};
  Typed typed;
  std::string command, frames_command;
  Job job;
};

constexpr const char* kManyInputs = "Bags, folders, .raw, .ply or .pcd files";

void define_view(Line& line) {
  Typed& t = line.typed;
  CLI::App* view = line.app.add_subcommand(
      "view",
      "Step through the octree traversal of a recording and find out why: the debugger's window.\n"
      "Without a display, --screenshot draws the same window into a picture.");
  add_inputs(view, t, kManyInputs);
  view->get_option("--frames")->description("The frame to begin with; all are in the strip");
  view->get_option("--frames")->type_name("N");
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(view, name, value, type, help)->group("Window");
  };
  option("--open", t.open, "FILE[#PLACE]",
         "A session that was saved, at one of its bookmarks; or a report.json, at f12/p3: at the "
         "decision that made plane 3 of frame 12, f12/was3: that lost the baseline's plane 3. r2/ "
         "before it: of the report's second recording");
  option("--baseline", t.baseline, "FILE",
         "Of the report that is opened, whose options become run A; default: the one it names");
  option("--script", t.script, "FILE.json", "Actions and input to begin with, docs/desktop.md");
  option("--screenshot", t.screenshot, "FILE.png", "Draw the window into a picture, and end");
  option("--state", t.state, "FILE.json", "Write what the window shows as plain facts");
  option("--size", t.size, "WxH", "Of the picture in pixels, default 1440x900");
  option("--scale", t.scale, "FACTOR", "Of text and lines in the picture, default 1");
  view->add_flag("--offscreen", t.offscreen, "No window, even where there is a display")
      ->group("Window");
  view->add_flag("--fresh", t.fresh, "Begin as on the first day, and remember nothing")
      ->group("Window");
  view->add_flag("--actions", t.actions, "List every action with its key")->group("Window");
  add_method(view, t);
  view->final_callback([&line] {
    const ViewArgs args = view_args(line.typed);
    line.job = [args](std::stop_token stop) { return run_view(args, stop); };
  });
}

void define_info(Line& line) {
  CLI::App* info = line.app.add_subcommand(
      "info", "What is in a recording: sizes, unit, intrinsics, gravity, time and gaps");
  add_inputs(info, line.typed, kManyInputs);
  add_json(info, line.typed);
  add_method(info, line.typed);
  info->final_callback([&line] {
    const InfoArgs args{input_args(line.typed), line.typed.json};
    line.job = [args](std::stop_token) { return run_info(args); };
  });
}

void define_segment(Line& line) {
  CLI::App* segment = line.app.add_subcommand(
      "segment",
      "Find the planes of each frame: planes.json, planes.png, cloud.ply, timings.json.\n"
      "Planes and cloud.ply are in the world frame: z up, metres.");
  add_inputs(segment, line.typed, "One bag, folder, .raw, .ply or .pcd file");
  add_out(segment, line.typed);
  add_json(segment, line.typed);
  add_method(segment, line.typed);
  segment->final_callback([&line] {
    const SegmentArgs args{input_args(line.typed), required_out(line.typed, "segment"),
                           line.typed.json};
    line.job = [args](std::stop_token stop) { return run_segment(args, stop); };
  });
}

void add_guard(CLI::App* command, Typed& t) {
  add(command, "--baseline", t.baseline, "FILE",
      "An earlier report.json: what became of its planes; exit code 1 where it got worse");
  add(command, "--rules", t.rules, "FILE",
      "planescope.rules.json: what the report is held to; with a baseline there are built-in ones");
  command->add_flag("--approve", t.approve, "The report becomes the baseline");
}

void define_report(Line& line) {
  CLI::App* report = line.app.add_subcommand(
      "report", "Write a report that opens in a browser: index.html, report.json, pictures");
  add_inputs(report, line.typed, kManyInputs);
  add_out(report, line.typed);
  add_json(report, line.typed);
  add_method(report, line.typed);
  add_guard(report, line.typed);
  add(report, "--shard", line.typed.shard, "I/N",
      "Only the I-th of N parts of the frames, to be joined by planescope report merge");
  report->add_flag("--no-pictures", line.typed.no_pictures,
                   "Figures alone: some ten times quicker, for a check before each commit");
  report->add_flag("--resume", line.typed.resume,
                   "Go on where a stopped run was: frames that it finished are taken as they are");
  report->add_flag(
      "--init", line.typed.init,
      "Write the built-in rules to planescope.rules.json, to be changed, and no report");
  CLI::App* merge = report->add_subcommand(
      "merge", "Join the shards of a report to what the report without --shard would have been");
  merge->add_option("SHARD", line.typed.shards, "Their folders, all of them")->type_name("");
  add_out(merge, line.typed);
  add_json(merge, line.typed);
  add_guard(merge, line.typed);
  merge->final_callback([&line] {
    const ReportMergeArgs args{{line.typed.shards.begin(), line.typed.shards.end()},
                               required_out(line.typed, "report merge"),
                               line.typed.json,
                               guard_args(line.typed)};
    if (args.shards.empty()) throw Error("report merge: give the folders of the shards");
    line.job = [args](std::stop_token) { return run_report_merge(args); };
  });
  report->final_callback([&line, report] {
    if (report->got_subcommand("merge")) return;
    if (line.typed.init) {
      for (const CLI::Option* option : report->get_options())
        if (option->count() > 0 && option->get_name() != "--init")
          throw Error("report --init: only writes planescope.rules.json, " + option->get_name() +
                      " says nothing of it");
      line.job = [](std::stop_token) { return run_report_init(); };
      return;
    }
    ReportArgs args{input_args(line.typed), required_out(line.typed, "report"),
                    line.typed.json,        line.frames_command,
                    guard_args(line.typed), {},
                    line.typed.resume,      !line.typed.no_pictures};
    if (!line.typed.shard.empty()) args.shard = parse_shard(line.typed.shard);
    line.job = [args](std::stop_token stop) { return run_report(args, stop); };
  });
}

void define_eval(Line& line) {
  CLI::App* eval = line.app.add_subcommand(
      "eval", "Metrics against ground truth: label files, or a cloud's fields");
  add_inputs(eval, line.typed, kManyInputs);
  add_json(eval, line.typed);
  add_method(eval, line.typed);
  add(eval, "--prediction", line.typed.prediction, "DIR",
      "Score what lies there instead: planescope segment's output, label files, or labels in\n"
      "another tool's format (docs/labels.md)");
  eval->final_callback([&line] {
    const EvalArgs args{input_args(line.typed), line.typed.prediction, line.typed.json};
    line.job = [args](std::stop_token stop) { return run_eval(args, stop); };
  });
}

void define_options(Line& line) {
  CLI::App* options = line.app.add_subcommand(
      "options", "List every option that --set takes, with value, unit and meaning");
  add_json(options, line.typed);
  add_method(options, line.typed);
  options->final_callback([&line] {
    const OptionsArgs args{pipeline_options(line.typed), line.typed.json};
    line.job = [args](std::stop_token) { return run_options(args); };
  });
}

void define_train(Line& line) {
  Typed& t = line.typed;
  CLI::App* train = line.app.add_subcommand(
      "train",
      "Train the classifier: on synthetic clouds, and on the labelled recordings that are given.\n"
      "Beside FILE: its curves as .html, and while it is not done a .checkpoint.");
  add_inputs(train, t, "Labelled bags, folders or clouds to learn from as well");
  add(train, "-o,--out", t.out, "FILE.safetensors", "The weights");
  add(train, "--recipe", t.recipe, "NAME",
      fmt::format("{}, or recordings: those that are given alone; default {}",
                  fmt::join(lab::recipe_names(), ", "), t.recipe));
  add(train, "--network", t.network, "compact|small|official", "Default compact");
  add(train, "--from", t.from, "FILE", "Weights to begin with, to teach them more");
  add(train, "--baseline", t.baseline, "FILE",
      "Weights to compare with in the end; exit code 1 where they are better by 0.3 points");
  add(train, "--steps", t.steps, "N", "Default: as the recipe has it");
  add(train, "--epoch", t.epoch, "N", "Steps between validations and checkpoints, default 2500");
  add(train, "--count", t.count, "N", "At most so many clouds of each kind; default all");
  add(train, "--seed", t.seed, "N", "Another seed makes other clouds and weights, default 1");
  train->add_flag("--balance-classes", t.balance_classes, "h and v weigh the same in each cloud");
  train->add_flag("--resume", t.resume, "Go on from FILE's checkpoint, to the same bytes");
  add_clouds(train, t);
  train->final_callback([&line] {
    TrainArgs args = train_args(line.typed);
    args.command = line.command;
    line.job = [args](std::stop_token stop) { return run_train(args, stop); };
  });
}

void define_bench(Line& line) {
  Typed& t = line.typed;
  CLI::App* bench =
      line.app.add_subcommand("bench", "Measure what planescope can do, and how fast");
  define_bench_paper(*bench, t, [&line](Job job) { line.job = std::move(job); });
  define_bench_real(*bench, t, [&line](Job job) { line.job = std::move(job); });

  CLI::App* classifier = bench->add_subcommand(
      "classifier",
      "Labels, planes and speed of networks against PCA normals, on synthetic clouds that no\n"
      "training has seen; and how long frames of the given recordings take.");
  add_inputs(classifier, t, "Bags, folders, .raw, .ply or .pcd files whose frames are timed");
  add_out(classifier, t);
  add_json(classifier, t);
  classifier
      ->add_option("--weights", t.weights,
                   wrapped("Networks to measure, side by side: gcn, the one that comes with "
                           "planescope (default), or files. May be given many times"))
      ->type_name("gcn|FILE")
      ->allow_extra_args(false);
  add(classifier, "--only", t.only, "PART,...",
      fmt::format("Of {}; default: all, frames where recordings are given",
                  fmt::join(bench_classifier_parts(), ", ")));
  add(classifier, "--seed", t.seed, "N", "Another seed makes other clouds");
  add(classifier, "--count", t.count, "N", "Clouds of each kind, default 100");
  add(classifier, "--rounds", t.rounds, "N", "How often speed is measured, default 20");
  add_method(classifier, t);
  for (const char* name : {"--labels", "--classifier", "--method"})
    classifier->remove_option(classifier->get_option(name));
  classifier->final_callback([&line] {
    BenchClassifierArgs args = bench_classifier_args(line.typed);
    args.command = line.command;
    line.job = [args](std::stop_token stop) { return run_bench_classifier(args, stop); };
  });

  CLI::App* desktop = bench->add_subcommand(
      "desktop",
      "How long the debugger's window takes to show a step and a slider's tick, drawn without a\n"
      "display, against an empty window in the same run.");
  add_inputs(desktop, t, "One bag, folder, .raw, .ply or .pcd file");
  add_out(desktop, t);
  add_json(desktop, t);
  add(desktop, "--steps", t.steps, "N", "Steps of the scrub, default 500");
  add(desktop, "--size", t.size, "WxH", "Of the window in pixels, default 1440x900");
  add_method(desktop, t);
  desktop->remove_option(desktop->get_option("--method"));
  desktop->final_callback([&line] {
    const BenchDesktopArgs args = bench_desktop_args(line.typed);
    line.job = [args](std::stop_token stop) { return run_bench_desktop(args, stop); };
  });
}

Job print_job(const std::string& text) {
  return [text](std::stop_token) {
    fmt::print("{}", text);
    return 0;
  };
}

}  // namespace

Job parse_command_line(int argc, char** argv) {
  Line line;
  line.command = command_text(argc, argv);
  line.frames_command = frames_command_text(argc, argv);
  CLI::App& app = line.app;
  app.set_version_flag("--version", "planescope " PLANESCOPE_VERSION);
  app.get_formatter()->column_width(34);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.footer(
      "planescope COMMAND --help tells more. Exit codes: 0 fine, 1 a comparison failed, 2 bad "
      "input "
      "or\nusage, 3 rendering failed (the data files are written), 130 cancelled.\n");
  define_view(line);
  define_info(line);
  define_segment(line);
  define_report(line);
  define_eval(line);
  define_options(line);
  define_synth(app, line.typed, [&line](Job job) { line.job = std::move(job); });
  define_train(line);
  define_bench(line);
  define_labels(app, line.typed, [&line](Job job) { line.job = std::move(job); });
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    command->group("Commands");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream text;
    app.exit(success, text, text);
    return print_job(text.str());
  } catch (const CLI::ParseError& error) {
    throw Error(message_of(app, error));
  }
  if (line.job) return line.job;
  if (const CLI::App* group = innermost(&app); group != &app)
    throw Error(fmt::format("{} needs one of: {}", group->get_name(),
                            fmt::join(subcommand_names(group), ", ")));
  const ViewArgs args = view_args(line.typed);  // plain `planescope`
  return [args](std::stop_token stop) { return run_view(args, stop); };
}

}  // namespace planescope::app
