// planescope convert: writes a recording in another format; depth stays bit-identical.

#include <fmt/format.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/inputs.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/recording_write.hpp"
#include "core/labels/model/grid.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

enum class Form : std::uint8_t { folder, tum, mcap, ply, pcd };
constexpr const char* kForms[] = {"folder", "tum", "mcap", "ply", "pcd"};
constexpr const char* kTitles[] = {"folder", "TUM", "MCAP", "PLY", "PCD"};

struct RecastArgs {
  InputArgs input;
  fs::path out;
  std::optional<Form> form;  // empty: derived from the extension of `out`
};

bool is_cloud_form(Form form) { return form == Form::ply || form == Form::pcd; }

Form form_called(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kForms); ++i)
    if (name == kForms[i]) return static_cast<Form>(i);
  throw Error(
      fmt::format("--to: unknown format '{}'; expected folder, tum, mcap, ply, or pcd", name));
}

/// Output path and format.
struct Target {
  fs::path out;
  Form form = Form::folder;
  bool one_file = false;  // `out` is one file, with one cloud or all frames
};

Target target_of(const RecastArgs& args, const OpenInput& input) {
  Target target{without_slash(args.out)};
  const std::string ending = lower_case(target.out.extension().string());
  target.one_file = ending == ".mcap" || ending == ".ply" || ending == ".pcd";
  if (target.one_file) {
    target.form = form_called(ending.substr(1));
    if (args.form && *args.form != target.form)
      throw Error(fmt::format("{}: --to {} does not match the extension {}", target.out.string(),
                              kForms[static_cast<std::size_t>(*args.form)], ending));
    if (target.form != Form::mcap && input.frames.size() != 1)
      throw Error(fmt::format(
          "{}: cannot contain all {} frames; expected a folder, or one frame (--frames N)",
          target.out.string(), input.frames.size()));
  } else if (ending == ".bag" || ending == ".db3") {
    throw Error(fmt::format(
        "{}: writing {} files is not supported; expected a folder, or a .mcap, .ply, or .pcd file",
        target.out.string(), ending));
  } else {
    target.form = args.form.value_or(input.recording->info().width > 0 ? Form::folder : Form::ply);
    if (target.form == Form::mcap)
      throw Error(target.out.string() +
                  ": --to mcap writes one file; expected a name that ends in .mcap");
  }
  if (input.recording->info().width == 0 && !is_cloud_form(target.form))
    throw Error(
        fmt::format("{}: contains point clouds, but {} output needs depth images; expected output "
                    "as .ply or .pcd",
                    input.path.string(), kTitles[static_cast<std::size_t>(target.form)]));
  if (input.recording->info().rounded && !is_cloud_form(target.form))
    throw Error(
        fmt::format("{}: depth is in meters (32FC1), which {} output would round to 16-bit counts; "
                    "expected output as .ply or .pcd",
                    input.path.string(), kTitles[static_cast<std::size_t>(target.form)]));
  if (fs::is_symlink(target.out) && !fs::exists(target.out))
    throw Error(target.out.string() + ": is a broken link; expected a new name");
  if (fs::exists(target.out) && !(fs::is_directory(target.out) && fs::is_empty(target.out)))
    throw Error(target.out.string() + ": already exists; expected a new name");
  return target;
}

/// Measured points of a depth image in sensor coordinates.
PointSet points_of(const Frame& frame) {
  if (frame.cloud) return *frame.cloud;
  const labels::LabelGrid grid = labels::make_label_grid(frame, Gravity{});
  PointSet set;
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    set.points.push_back(grid.points[i]);
    if (!grid.color.empty())
      set.rgb.insert(set.rgb.end(), &grid.color.data[3 * i], &grid.color.data[3 * i] + 3);
  }
  return set;
}

/// Writes a cloud and returns the facts that its format cannot store.
io::WrittenFrame write_cloud(const fs::path& path, Form form, const Frame& frame) {
  const PointSet points = points_of(frame);
  write_file_bytes(path, form == Form::ply ? io::ply_bytes(points) : io::pcd_bytes(points));
  io::WrittenFrame written{{}, path.stem().string(), false};
  written.facts.timestamp_s = frame.timestamp_s;
  written.facts.gravity = frame.gravity;
  return written;
}

io::WrittenFrame write_one(Form form, const fs::path& dir, int number, const Frame& frame) {
  if (form == Form::folder) return io::write_frame(dir, io::FolderForm::open3d, number, frame);
  if (form == Form::tum) return io::write_frame(dir, io::FolderForm::tum, number, frame);
  const std::string ending = kForms[static_cast<std::size_t>(form)];
  return write_cloud(dir / fmt::format("{:06}.{}", number, ending), form, frame);
}

void write_facts(Form form, const fs::path& dir, const std::vector<io::WrittenFrame>& frames) {
  if (is_cloud_form(form)) return io::write_frame_facts(dir / "planescope.json", frames);
  io::write_folder_facts(dir, form == Form::tum ? io::FolderForm::tum : io::FolderForm::open3d,
                         frames);
}

/// Warns if the clouds have camera axes, which their format cannot express.
void warn_of_axes(const OpenInput& input, const io::WrittenFrame& written) {
  const Frame frame = input.recording->frame(input.frames[0]);
  if (!written.facts.gravity && (!frame.is_cloud() || frame.cloud->optical))
    notice("gravity is unknown: z in the point clouds is the camera's viewing direction, not up");
}

/// Reads the output back. Throws Error if a frame is missing or its depth differs.
void check_written(const OpenInput& input, const fs::path& dir, bool same_data) {
  const auto written = io::open_recording(dir);
  if (written->frame_count() != static_cast<int>(input.frames.size()))
    throw Error(fmt::format("{}: contains {} frames after writing; expected {}", dir.string(),
                            written->frame_count(), input.frames.size()));
  if (!same_data) return;
  for (int i = 0; i < written->frame_count(); ++i)
    if (const int from = input.frames[static_cast<std::size_t>(i)];
        written->frame_hash(i) != input.recording->frame_hash(from))
      throw Error(
          fmt::format("{}: frame {} does not read back as it was written", dir.string(), from));
}

/// Copies the label files of the frames with new numbers. Returns their number.
int copy_labels(const OpenInput& input, const fs::path& name, StagedOutput& staged) {
  if (!fs::exists(input.label_dir)) return 0;
  const fs::path to = staged.add(name);
  int copied = 0;
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    const int from = input.frames[i];
    const std::optional<int> number = input.label_number(from);
    if (!number) continue;
    const auto labels = labels::read_frame_labels(input.label_dir, *number,
                                                  {input.recording->frame_hash(from).c_str()});
    if (!labels) continue;
    labels::write_frame_labels(to, static_cast<int>(i), *labels);
    ++copied;
  }
  return copied;
}

/// Writes all readable frames in order.
std::vector<io::WrittenFrame> write_mcap(const OpenInput& input,
                                         const fs::path& path,
                                         int threads,
                                         const std::stop_token& stop,
                                         DamagedFrames& damaged) {
  std::vector<io::WrittenFrame> written;
  write_file_stream(path, [&](std::ostream& out) {
    io::McapWriter file(out);
    damaged = run_frames(
        "convert", input.frames, threads, stop,
        [&](std::size_t i) {
          return read_frame([&] { return input.recording->frame(input.frames[i]); });
        },
        [&](std::size_t, Frame&& frame) {
          // Keep depth counts; their unit goes into the sidecar.
          const std::int64_t stamp_ns = io::ros_stamp(frame.timestamp_s);
          for (const io::RosMessage& message :
               io::ros_camera(frame, stamp_ns, io::DepthEncoding::counts))
            file.add(message, stamp_ns, message.topic == "/tf_static");
          file.end_chunk();
          written.push_back(io::facts_of(std::move(frame), std::to_string(written.size())));
        });
    if (stop.stop_requested()) throw Cancelled();
    file.finish();
  });
  return written;
}

fs::path facts_of(const Target& target) { return target.out.string() + ".planescope.json"; }

/// Writes all frames to one file, with a sidecar for facts that the format cannot store.
std::vector<io::WrittenFrame> write_one_file(OpenInput& input,
                                             const Target& target,
                                             StagedOutput& staged,
                                             bool same_data,
                                             int threads,
                                             const std::stop_token& stop,
                                             DamagedFrames& damaged) {
  const fs::path file = staged.add_file(target.out.filename());
  const fs::path sidecar = staged.add_file(facts_of(target).filename());
  std::vector<io::WrittenFrame> written;
  if (target.form == Form::mcap) {
    written = write_mcap(input, file, threads, stop, damaged);
    damaged.remove_from(input.frames);
    io::write_recording_facts(sidecar, written);
  } else {
    written.push_back(write_cloud(file, target.form, input.recording->frame(input.frames[0])));
    io::write_frame_facts(sidecar, written);
  }
  check_written(input, file, same_data);
  return written;
}

int run_convert(const RecastArgs& args, const std::stop_token& stop) {
  InputArgs input_args = args.input;
  input_args.recording.standard_input = true;
  std::vector<OpenInput> inputs = open_inputs(input_args, args.out);
  if (inputs.size() != 1)
    throw Error(fmt::format("convert: {} recordings; expected one", inputs.size()));
  OpenInput& input = inputs[0];
  const Target target = target_of(args, input);
  const bool is_cloud = input.recording->info().width == 0;
  const bool same_data = is_cloud == is_cloud_form(target.form);

  const fs::path labels = labels::default_label_dir(target.out);
  const fs::path parent = target.out.has_parent_path() ? target.out.parent_path() : ".";
  for (const auto& [beside, counts] :
       {std::pair(labels, same_data), {facts_of(target), target.one_file}})
    if (counts && fs::exists(beside) && !is_unfinished(parent, target.out.filename()))
      throw Error(beside.string() + ": already exists; expected a new name");
  const int threads = args.input.pipeline.threads;
  StagedOutput staged(parent);
  const std::size_t asked = input.frames.size();
  std::vector<io::WrittenFrame> frames;
  DamagedFrames damaged;
  if (target.one_file) {
    frames = write_one_file(input, target, staged, same_data, threads, stop, damaged);
  } else {
    const fs::path dir = staged.add(target.out.filename());
    // A damaged frame leaves a gap in the numbers of the files.
    damaged = run_frames(
        "convert", input.frames, threads, stop,
        [&](std::size_t i) {
          const Frame frame = read_frame([&] { return input.recording->frame(input.frames[i]); });
          return write_one(target.form, dir, static_cast<int>(i), frame);
        },
        [&](std::size_t, io::WrittenFrame&& frame) { frames.push_back(std::move(frame)); });
    if (stop.stop_requested()) throw Cancelled();
    damaged.remove_from(input.frames);
    write_facts(target.form, dir, frames);
    check_written(input, dir, same_data);
  }
  const int labeled = same_data ? copy_labels(input, labels.filename(), staged) : 0;
  staged.commit();
  if (is_cloud_form(target.form)) warn_of_axes(input, frames[0]);
  fmt::print("{}: {} of {} frames from {}{}, read back{}\n", target.out.string(), frames.size(),
             asked, input.path.string(),
             labeled > 0 ? fmt::format(" with labels for {}", labeled) : "",
             same_data ? " and bit-identical" : "");
  return damaged.report(asked);
}

}  // namespace

void define_convert(CLI::App& app, Line& line) {
  CLI::App* command = app.add_subcommand(
      "convert", "Convert a recording to another format\nColor, gravity, and labels are kept.");
  const auto args = std::make_shared<RecastArgs>();
  add_recordings(command, args->input, false);
  add(command, "-o,--out", args->out, "OUT",
      "New folder, .mcap file, or .ply or .pcd file for a single frame")
      ->required();
  add_read(
      command, "--to", [args](const std::string& name) { args->form = form_called(name); },
      "folder|tum|mcap|ply|pcd",
      "Format: folder, numbered PNGs as written by Open3D's recorder (default); tum, PNGs named by "
      "time; mcap, a ROS 2 recording; ply or pcd, one cloud per frame, in the sensor's frame");
  runs(command, line, args, run_convert);
}

}  // namespace planescope::app
