// planescope labels export, import and convert.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/labels.hpp"
#include "core/io/image/png.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/planes/cloud/gravity.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

OpenInput open_one(const LabelsArgs& args, const std::string& command) {
  if (args.input.inputs.size() != 1)
    throw Error(
        fmt::format("labels {}: {} recordings; expected one", command, args.input.inputs.size()));
  InputArgs input = args.input;
  input.label_dir.reset();                                    // may be missing
  input.recording.intrinsics_may_lack = command == "export";  // the label files then provide them
  OpenInput opened = std::move(open_inputs(input, args.out)[0]);
  if (args.input.label_dir) opened.label_dir = *args.input.label_dir;
  return opened;
}

struct FileOfFrame {
  int frame = 0;
  fs::path path;
  std::optional<std::size_t> image;  // of a COCO file with several frames
};

/// Matches the images of a COCO file to frames by name.
std::vector<FileOfFrame> images_to_import(const labels::CocoFile& coco,
                                          const fs::path& path,
                                          const OpenInput& input) {
  std::vector<FileOfFrame> files;
  for (const int frame : input.frames)
    if (const auto image = coco.image_of_frame(frame)) files.push_back({frame, path, image});
  if (files.empty())
    throw Error(fmt::format("{}: no image matches a frame; expected names such as {:06}.png",
                            path.string(), input.frames[0]));
  return files;
}

/// Returns the COCO file with all frames: that of an exported folder, or one with several images.
std::optional<fs::path> coco_to_import(const LabelsArgs& args, labels::LabelFormat format) {
  if (format != labels::LabelFormat::coco) return std::nullopt;
  if (fs::is_directory(args.from)) {
    const fs::path path = args.from / labels::kCocoFileName;
    return fs::exists(path) ? std::optional(path) : std::nullopt;
  }
  return fs::exists(args.from) ? std::optional(args.from) : std::nullopt;
}

/// One file for the single selected frame, or the files of a folder, named as by export.
std::vector<FileOfFrame> files_to_import(const LabelsArgs& args,
                                         const OpenInput& input,
                                         labels::LabelFormat format,
                                         const std::optional<labels::CocoFile>& coco,
                                         const std::optional<fs::path>& coco_path) {
  if (!fs::exists(args.from)) throw Error(args.from.string() + ": no such file or folder");
  const bool is_one = coco && coco->names().size() == 1 && !fs::is_directory(args.from);
  if (coco && !is_one) return images_to_import(*coco, *coco_path, input);
  if (!fs::is_directory(args.from)) {
    if (input.frames.size() != 1)
      throw Error(fmt::format(
          "{}: is a single file, but {} frames are selected; select its frame with --frames N",
          args.from.string(), input.frames.size()));
    return {{input.frames[0], args.from, {}}};
  }
  const std::string extension = labels::extension_of(format);
  std::vector<FileOfFrame> files;
  for (const int frame : input.frames) {
    const fs::path path = args.from / fmt::format("{:06}{}", frame, extension);
    if (fs::exists(path)) files.push_back({frame, path, {}});
  }
  if (files.empty())
    throw Error(fmt::format("{}: no file matches a frame; expected names such as {:06}{}",
                            args.from.string(), input.frames[0], extension));
  return files;
}

struct Import {
  labels::LabelEdit edit;
  std::size_t planes = 0, pixels = 0;
  std::size_t ignored = 0;  // not scored, in addition to the labeled ones
  std::size_t dropped = 0;  // labels on pixels without depth
  const char* sample = "pixel";
};

std::size_t labeled_in(const labels::LabeledPoints& points) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    count += points.instance[i] != 0 || (!points.label.empty() && points.label[i] != 0);
  return count;
}

Import read_import(const FileOfFrame& file,
                   labels::LabelFormat format,
                   const std::optional<labels::CocoFile>& coco,
                   const OpenInput& input,
                   const planes::PipelineOptions& options,
                   labels::LabelStore& store) {
  const labels::LabeledPoints points =
      file.image ? coco->points(*file.image) : labels::read_labeled(file.path, format);
  const Frame frame = input.frame(file.frame);
  const std::string hash = input.recording->frame_hash(file.frame);
  const labels::LabelGrid grid = labels::make_label_grid(
      frame, planes::resolve_gravity(frame, options.gravity, options.cloud.max_range_m));
  const auto before = store.open(file.frame, labels::empty_labels(grid, hash));
  FrameLabels after = labels::labels_of_points(points, grid, hash, file.path.string());
  after.annotator = before->annotator;

  Import import;
  if (grid.is_cloud()) import.sample = "point";
  import.edit =
      labels::make_edit(file.frame, "Import " + file.path.filename().string(), *before, after);
  import.planes = after.planes.size();
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    const bool ignored = after.plane.data[i] == kPlaneIgnore || after.hv.data[i] == kHvIgnore;
    import.ignored += ignored;
    import.pixels += !ignored && (after.plane.data[i] != 0 || after.hv.data[i] != 0);
  }
  import.dropped = labeled_in(points) - import.pixels - import.ignored;
  return import;
}

/// "evops|ply|...".
std::string format_names(bool read_back) {
  std::vector<std::string> names;
  for (const labels::LabelFormat format : labels::label_formats(read_back))
    names.emplace_back(labels::to_string(format));
  return fmt::format("{}", fmt::join(names, "|"));
}

int run_labels_export(const LabelsArgs& args, const std::stop_token& stop) {
  const labels::LabelFormat format = labels::parse_label_format(args.format);
  check_output_dir(args.out);
  const OpenInput input = open_one(args, "export");
  if (fs::weakly_canonical(args.out) == fs::weakly_canonical(input.label_dir))
    throw Error(args.out.string() + ": is the label folder itself; expected a different folder");
  list_labels(input.label_dir);  // throws if there are none
  std::vector<int> frames = input.frames;
  std::erase_if(frames, [&](int frame) { return !input.label_number(frame); });
  if (frames.empty())
    throw Error(input.label_dir.string() + ": no labels for the requested frames");
  std::vector<fs::path> written;
  const bool is_coco = format == labels::LabelFormat::coco;
  labels::CocoWriter coco;  // one file for all frames
  const auto picture_of = [](int frame) {
    return fmt::format("{}/{:06}.png", labels::kCocoPictures, frame);
  };
  struct Exported {
    std::vector<fs::path> paths;
    labels::LabeledPoints coco;
  };
  const auto make = [&](std::size_t i) -> Exported {
    const int index = frames[i];
    Frame frame = read_frame([&] { return input.recording->frame(index); });
    const auto labels = labels::read_labels_of_frame(
        input.label_dir, frame, input.recording->frame_hash(index), input.label_number(index));
    if (!labels) return {};
    frame = frame_as_drawn(std::move(frame), input.recording->info(), *labels);
    if (frame.is_cloud() && is_coco)
      throw Error(
          fmt::format("{}, frame {}: format coco is for images, but this is a cloud; expected "
                      "--format evops, ply, pcd, kitti, npz, or voxels",
                      input.path.string(), index));
    make_output_dir(args.out);
    const labels::LabelGrid grid = labels::make_label_grid(frame, labels->gravity);
    labels::LabeledPoints points = labels::points_of_labels(*labels, grid);
    if (!is_coco)
      return {labels::write_labeled(args.out / fmt::format("{:06}", index), format, points,
                                    args.input.pipeline.cloud.voxel_size_m),
              {}};
    make_output_dir(args.out / labels::kCocoPictures);
    io::write_png(args.out / picture_of(index), labels::coco_picture(grid));
    return {{args.out / picture_of(index)}, std::move(points)};
  };
  const DamagedFrames damaged =
      run_frames("export", frames, args.input.pipeline.threads, stop, make,
                 [&](std::size_t i, Exported&& exported) {
                   written.insert(written.end(), exported.paths.begin(), exported.paths.end());
                   if (is_coco && !exported.paths.empty())
                     coco.add(exported.coco, picture_of(frames[i]));
                 });
  if (stop.stop_requested()) throw Cancelled();
  if (is_coco && !written.empty()) {
    written.push_back(args.out / labels::kCocoFileName);
    write_file_bytes(written.back(), coco.bytes(), Durable::yes);
  }
  for (const fs::path& path : written) fmt::print("{}\n", path.string());
  return damaged.report(frames.size());
}

/// Reads all files before changing any labels; undo restores the previous labels.
int run_labels_import(const LabelsArgs& args, const std::stop_token& stop) {
  if (args.from.empty()) throw Error("labels import needs --from FILE or DIR");
  if (args.format.empty() && fs::is_directory(args.from))
    throw Error("labels import needs --format if --from is a folder");
  const labels::LabelFormat format = args.format.empty() ? labels::label_format_of(args.from)
                                                         : labels::parse_label_format(args.format);
  const OpenInput input = open_one(args, "import");
  check_outside(input.label_dir, input.path);
  const std::optional<fs::path> coco_path = coco_to_import(args, format);
  std::optional<labels::CocoFile> coco;
  if (coco_path) coco = labels::read_coco(*coco_path);
  auto files = files_to_import(args, input, format, coco, coco_path);
  const bool is_new = !fs::exists(input.label_dir);
  labels::LabelStore store(input.label_dir);
  if (!store.read_only().empty()) throw Error(input.label_dir.string() + ": " + store.read_only());
  for (const std::string& what : store.notices()) notice("warning: {}", what);

  std::vector<Import> imports;
  std::vector<int> frames;
  for (const FileOfFrame& file : files) frames.push_back(file.frame);
  const DamagedFrames damaged = for_each_frame("import", frames, stop, [&](int frame) {
    const auto file = std::ranges::find(files, frame, &FileOfFrame::frame);
    try {
      imports.push_back(read_import(*file, format, coco, input, args.input.pipeline, store));
    } catch (const Error&) {
      // The files of labels that another process is writing are incomplete.
      if (is_new && fs::exists(input.label_dir))
        throw Error(input.label_dir.string() +
                    ": was held by another process, which created it; import again");
      throw;
    }
  });
  damaged.remove_from(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    store.commit(imports[i].edit);
    store.save(files[i].frame);
    fmt::print("frame {}: {}: {}, {} labeled{}{}{}\n", files[i].frame, files[i].path.string(),
               counted(imports[i].planes, "plane"), counted(imports[i].pixels, imports[i].sample),
               imports[i].ignored > 0 ? fmt::format(", {} not scored", imports[i].ignored) : "",
               imports[i].dropped > 0
                   ? fmt::format(
                         ", {} labels without {} skipped", imports[i].dropped,
                         imports[i].sample == std::string_view("point") ? "a measurement" : "depth")
                   : "",
               imports[i].edit.empty() ? ", unchanged" : "");
  }
  return damaged.report(frames.size());
}

struct ConvertArgs {
  fs::path in, out;
};

int run_labels_convert(const ConvertArgs& args, const std::stop_token&) {
  const fs::path& in = args.in;
  const labels::LabelFormat to = labels::label_format_of(args.out);
  const labels::LabeledPoints points = labels::read_labeled(in, labels::label_format_of(in));
  for (const fs::path& path :
       labels::write_labeled(fs::path(args.out).replace_extension(), to, points))
    fmt::print("{}\n", path.string());
  return 0;
}

}  // namespace

void define_labels_export(CLI::App* labels, Line& line) {
  CLI::App* command = labels->add_subcommand(
      "export",
      "Write labels in another tool's format\nWrites one file per frame; for coco, one file.");
  const auto args = std::make_shared<LabelsArgs>();
  add_inputs(command, args->input, "Recording with labels");
  add(command, "--format", args->format, format_names(false), "Format to write")->required();
  add_of_method(command, args->input.pipeline, "--voxel", "M",
                "Voxel edge for format voxels in meters (default 0.02)");
  add_out(command, args->out)->required();
  runs(command, line, args, run_labels_export);
}

void define_labels_import(CLI::App* labels, Line& line) {
  CLI::App* command = labels->add_subcommand("import",
                                             "Import labels from another tool's files\n"
                                             "Undo restores the previous labels.");
  const auto args = std::make_shared<LabelsArgs>();
  add_inputs(command, args->input, "Recording that the labels belong to");
  command->get_option("--labels")
      ->description("Folder to import to (default RECORDING.labels, next to the recording)");
  add(command, "--format", args->format, format_names(true),
      "Format of the files (default: from the extension of --from FILE)");
  add(command, "--from", args->from, "FILE|DIR",
      "Exported file for the frame given with --frames, or folder of exported files")
      ->required();
  add_of_method(command, args->input.pipeline, "--gravity", "auto|X,Y,Z|imu|estimate|none",
                "Gravity direction in the sensor's frame (default auto)");
  runs(command, line, args, run_labels_import);
}

void define_labels_convert(CLI::App* labels, Line& line) {
  std::vector<std::string> endings;
  for (const labels::LabelFormat format : labels::label_formats(true))
    endings.emplace_back(labels::extension_of(format));
  CLI::App* command = labels->add_subcommand(
      "convert",
      fmt::format("Convert a label file to another format\nThe extension selects the format: {}.",
                  fmt::join(endings, ", ")));
  const auto args = std::make_shared<ConvertArgs>();
  add(command, "IN", args->in, "", "Label file to read")->required();
  add(command, "-o,--out", args->out, "FILE", "Label file to write")->required();
  runs(command, line, args, run_labels_convert);
}

}  // namespace planescope::app
