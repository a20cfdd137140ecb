// planescope labels: its commands and their options.

#include <CLI/CLI.hpp>

#include "app/cli/cli_parts.hpp"
#include "app/commands/labels.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

constexpr const char* kReadFormats = "evops|ply|pcd|kitti|npz|coco";
constexpr const char* kFormats = "evops|ply|pcd|kitti|npz|coco|voxels";

LabelsArgs labels_args(const Typed& typed) {
  LabelsArgs args;
  args.input = input_args(typed);
  args.recording = typed.recording;
  args.format = typed.format;
  args.from = typed.from;
  args.out = typed.out;
  args.strict = typed.strict;
  args.json = typed.json;
  return args;
}

void add_recording(CLI::App* command, Typed& t) {
  add(command, "--recording", t.recording, "RECORDING",
      "What the labels were drawn on; otherwise the one that DIR.labels is named after");
}

/// Of the options of recordings, those for a folder of labels.
void keep_camera_options(CLI::App* command) {
  for (const char* name : {"--frames", "--labels"})
    command->remove_option(command->get_option(name));
}

}  // namespace

void define_labels(CLI::App& app, Typed& typed, std::function<void(Job)> choose) {
  CLI::App* labels = app.add_subcommand(
      "labels", "Check, compare, export and import ground truth (docs/labels.md)");
  Typed* t = &typed;
  const auto command = [&](const char* name, const char* help) {
    return labels->add_subcommand(name, help);
  };
  const auto runs = [t, choose](CLI::App* sub,
                                int (*run)(const LabelsArgs&, const std::stop_token&)) {
    sub->final_callback([t, choose, run] {
      choose(
          [args = labels_args(*t), run](const std::stop_token& stop) { return run(args, stop); });
    });
  };

  CLI::App* check =
      command("check",
              "What is damaged or looks wrong, a line each. Exit code 0 nothing but hints,\n"
              "1 findings, 2 damaged files");
  add_inputs(check, typed, "A folder of labels, or a recording");
  keep_camera_options(check);
  add(check, "--labels", typed.labels, "DIR", "Of a recording; otherwise <recording>.labels");
  add_recording(check, typed);
  check->add_flag("--strict", typed.strict, "Exit code 1 for hints, too");
  add_json(check, typed);
  runs(check, run_labels_check);

  CLI::App* stats = command("stats", "Planes, labelled area, and who worked how long, by frame");
  add_inputs(stats, typed, "A folder of labels, or a recording");
  keep_camera_options(stats);
  add(stats, "--labels", typed.labels, "DIR", "Of a recording; otherwise <recording>.labels");
  add_recording(stats, typed);
  add_json(stats, typed);
  runs(stats, run_labels_stats);

  CLI::App* compare = command("compare", "How far two sets of labels of the same frames agree");
  add_inputs(compare, typed, "Two folders of labels, DIR_A and DIR_B");
  keep_camera_options(compare);
  add_recording(compare, typed);
  add_json(compare, typed);
  runs(compare, run_labels_compare);

  CLI::App* exporting =
      command("export", "Write labels in another tool's format, a file per frame");
  add_inputs(exporting, typed, "A recording with labels");
  add(exporting, "--format", typed.format, kFormats, "What to write");
  add(exporting, "--voxel", typed.voxel, "M", "Edge of a voxel of format voxels, default 0.02");
  add_out(exporting, typed);
  exporting->final_callback([t, choose] {
    LabelsArgs args = labels_args(*t);
    args.out = required_out(*t, "labels export");
    choose([args](const std::stop_token& stop) { return run_labels_export(args, stop); });
  });

  CLI::App* importing =
      command("import",
              "Take labels from another tool's files. What was there can be brought back by undo");
  add_inputs(importing, typed, "The recording that the labels are of");
  importing->get_option("--labels")
      ->description(wrapped("Where the labels go; otherwise <recording>.labels beside it"));
  add(importing, "--format", typed.format, kReadFormats,
      "What the files are; otherwise as --from FILE is named");
  add(importing, "--from", typed.from, "FILE|DIR",
      "One file, for the frame of --frames; or a folder with files as export names them");
  add(importing, "--gravity", typed.gravity, "auto|X,Y,Z|imu|estimate|none",
      "Direction in which things fall, in the sensor's own frame; default auto");
  runs(importing, run_labels_import);

  CLI::App* convert = command(
      "convert",
      "From one format to another, as the names end: .npy, .ply, .pcd, .label, .npz, .json");
  add(convert, "IN", typed.from, "", "A file with labels");
  add(convert, "-o,--out", typed.out, "FILE", "What to write");
  convert->final_callback([t, choose] {
    if (t->from.empty()) throw Error("labels convert needs a file to read");
    LabelsArgs args = labels_args(*t);
    args.input.inputs = {t->from};
    args.out = required_out(*t, "labels convert");
    choose([args](std::stop_token) { return run_labels_convert(args); });
  });
}

}  // namespace planescope::app
