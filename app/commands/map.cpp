// planescope map: builds a map of tracked planes from the frames of a recording.

#include <fmt/format.h>

#include <fstream>
#include <mutex>
#include <span>
#include <utility>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/map_picture.hpp"
#include "app/commands/report.hpp"
#include "app/commands/segment.hpp"
#include "core/io/image/png.hpp"
#include "core/io/open3d/install.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastWindow_m = 0.5;
constexpr int kMostAside = 4;  // at most one frame in this number may not fit the others

struct MapArgs {
  InputArgs input;  // one recording
  fs::path out;     // -o
  std::optional<fs::path> poses;
  world::TrackOptions tracks;
  bool follow = false;
  std::optional<Shard> shard;
  fs::path join;            // output folder of shards; empty: none
  double mesh_voxel_m = 0;  // --mesh; 0: no mesh
};

/// Returns "map.png"; for later segments, "map_1.png".
std::string file_of_segment(const std::string& name, int segment, const char* type) {
  return segment == 0 ? name + type : fmt::format("{}_{}{}", name, segment, type);
}

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Whether planescope map writes files with this name, for any frame or segment.
bool is_of_map(const fs::path& relative) {
  const std::string stem = relative.stem().string(), type = relative.extension().string();
  if (relative.has_parent_path()) return type == ".png" && stem.size() >= 6 && is_number(stem);
  if (relative == "pace.json" || relative == "left.jsonl") return true;
  const std::size_t end = std::min(stem.find('_'), stem.size());
  const std::string name = stem.substr(0, end);
  return (end == stem.size() || is_number(std::string_view(stem).substr(end + 1))) &&
         ((name == "map" && type == ".png") || (name == "mesh" && type == ".ply"));
}

/// Files of an earlier map in `dir`.
std::vector<fs::path> files_of_map(const fs::path& dir) {
  std::vector<fs::path> files;
  for (const fs::path& folder : {fs::path(), world::planes_file({}, 0).parent_path()}) {
    std::error_code absent;
    for (const fs::directory_entry& entry : fs::directory_iterator(dir / folder, absent))
      if (const fs::path relative = folder / entry.path().filename(); is_of_map(relative))
        files.push_back(relative);
  }
  return files;
}

/// Whether planescope map wrote it.
bool is_tracks_file(const fs::path& file) {
  std::error_code absent;
  if (!fs::is_regular_file(file, absent)) return false;
  std::string start(64, '\0');
  open_to_read(file).read(start.data(), static_cast<std::streamsize>(start.size()));
  return start.find("\"planescope.tracks/") != std::string::npos;
}

/// Throws Error where the map would replace or remove files that are not of an earlier map.
void check_not_of_user(const fs::path& dir) {
  // commit() writes tracks.json first, so that it is there even if an earlier run was killed.
  if (is_tracks_file(dir / "tracks.json")) return;
  std::vector<fs::path> files = files_of_map(dir);
  for (const char* name : {"map.json", "poses.tum", "tracks.json"})
    if (fs::exists(dir / name)) files.emplace_back(name);
  if (!files.empty())
    throw Error(
        fmt::format("{}: already exists, but is not part of an earlier map; expected a new or "
                    "empty folder, or an earlier map",
                    (dir / *std::ranges::min_element(files)).string()));
}

/// Writes map.json, tracks.json, poses.tum, the pictures and pace.json.
void write_map(StagedOutput& output, const world::WorldMap& map, const std::string& recording) {
  const world::MapTexts texts = world::map_texts(map, recording);
  write_file_text(output.add_file("poses.tum"), texts.poses_tum);
  write_file_text(output.add_file("tracks.json"), texts.tracks_json);
  const int last = std::max(map.poses.poses.back().segment, map.tracker.frames().back().segment);
  bool is_first = true;
  for (int segment = 0; segment <= last; ++segment) {
    const Image8 picture = map_from_above(map, segment);
    if (picture.empty()) continue;
    const int number = std::exchange(is_first, false) ? 0 : segment;
    io::write_png(output.add_file(file_of_segment("map", number, ".png")), picture);
  }
  if (map.pace) write_file_text(output.add_file("pace.json"), world::pace_json(*map.pace));
  write_file_text(output.add_file("map.json"), texts.map_json);
}

/// If requested, writes mesh.ply for each segment from the frames in the map.
void write_meshes(const MapArgs& args,
                  const world::MapJob& job,
                  const world::WorldMap& map,
                  StagedOutput& output) {
  if (!(args.mesh_voxel_m > 0)) return;
  const std::vector<world::FrameOfTracks>& tracked = map.tracker.frames();
  const auto count = static_cast<int>(tracked.size());
  std::unique_ptr<open3d::SurfaceFusion> fusion;
  const auto finish = [&](int segment) {
    const std::string file = file_of_segment("mesh", segment, ".ply");
    if (!fusion || !fusion->write_ply(output.add_file(file)))
      notice("{}: not written: no surface was found", (args.out / file).string());
    fusion.reset();
  };
  for (int i = 0; i < count; ++i) {
    if (job.stop.stop_requested()) throw Cancelled();
    job.progress("mesh", i + 1, count);
    if (i > 0 && tracked[i].segment != tracked[i - 1].segment) finish(tracked[i - 1].segment);
    const world::CameraPose* pose = world::pose_of(map.poses, tracked[i].frame);
    if (!tracked[i].is_in_map() || !pose) continue;
    if (!fusion)
      fusion = open3d::make_surface_fusion(args.mesh_voxel_m, job.pipeline.cloud.max_range_m);
    fusion->add(job.recording->frame(tracked[i].frame), pose->T_world_camera);
  }
  finish(tracked.back().segment);
}

/// Throws the errors of write_meshes() before any work is done.
void expect_meshes(const MapArgs& args, const io::RecordingInfo& info) {
  if (!(args.mesh_voxel_m > 0)) return;
  open3d::make_surface_fusion(args.mesh_voxel_m, 0);
  if (info.intrinsics.distortion != Distortion::none)
    throw Error(info.path.string() + ": has lens distortion, which --mesh does not support");
}

fs::path observed_file(const fs::path& dir, int frame) {
  return dir / "observed" / fmt::format("{:06}.cbor", frame);
}

/// Writes DIR/observed/ with one file per frame of the shard. Returns the exit code.
int write_shard(const MapArgs& args, const world::MapJob& job) {
  make_output_dir(args.out / "observed");
  world::PlanesFrom from;
  std::size_t written = 0;
  const auto shards = static_cast<std::size_t>(args.shard->count);
  const auto mine = static_cast<std::size_t>(args.shard->index - 1);
  const world::ObservedPart part = world::observe_recording(
      job, [&](std::size_t position) { return position % shards == mine; },
      [&](const world::ObservedFrame& frame, const world::UprightPoses& upright) {
        if (from.empty()) from = world::planes_from(job.pipeline, job.recording->info(), upright);
        write_file_bytes(observed_file(args.out, frame.frame), world::observed_bytes(frame, from));
        ++written;
      });
  for (const std::string& line : part.warnings) notice("{}", line);
  fmt::print("{}: {} of shard {}/{}\n", args.out.string(), counted(written, "frame"),
             args.shard->index, args.shard->count);
  return part.refused > 0 ? 2 : 0;
}

/// Reads frames from the output of shards.
void join_shards(const fs::path& dir, world::MapJob& job) {
  if (!fs::is_directory(dir / "observed"))
    throw Error(dir.string() + ": contains no `observed` folder; expected the output of --shard");
  job.observed = [dir, options = job.pipeline, info = job.recording->info(),
                  from = world::PlanesFrom(), once = std::make_shared<std::once_flag>()](
                     int frame, const world::UprightPoses& upright) mutable {
    std::call_once(*once, [&] { from = world::planes_from(options, info, upright); });
    const fs::path file = observed_file(dir, frame);
    if (!fs::exists(file))
      throw Error(file.string() +
                  ": is missing: its shard did not finish, or could not read the frame");
    world::ObservedFrame observed = world::read_observed(file, from);
    if (observed.frame != frame)
      throw Error(fmt::format("{}: contains frame {}; expected frame {}", file.string(),
                              observed.frame, frame));
    return observed;
  };
}

int run_map(const MapArgs& args, std::stop_token stop) {
  if (args.input.inputs.size() > 1)
    throw Error(fmt::format("map: {} recordings; expected one", args.input.inputs.size()));
  if (args.input.pipeline.classifier == "truth")
    throw Error("map: --classifier truth is not supported: it needs labeled frames");
  const bool in_file = is_planes_file(args.out);
  if (!in_file) check_output_dir(args.out);
  world::MapJob job;
  if (args.poses) job.trajectory = world::read_trajectory(*args.poses);
  const std::vector<OpenInput> inputs = open_inputs(args.input, args.out);
  const OpenInput& input = inputs.front();
  std::optional<PlanesFile> file;
  if (in_file)
    file.emplace(args.out);
  else
    check_not_of_user(args.out);
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);
  job.recording = input.recording.get();
  job.frames = input.frames;
  job.pipeline = args.input.pipeline;
  job.classifier = chosen.classifier.get();
  job.tracks = args.tracks;
  job.threads = args.input.pipeline.threads;
  job.stop = stop;
  job.at_own_rate = args.follow;
  if (args.shard) {
    job.progress = StageBar("map");
    return write_shard(args, job);
  }
  if (!args.join.empty()) join_shards(args.join, job);
  expect_meshes(args, job.recording->info());
  const fs::path dir = file ? file->work_folder() : args.out;
  StagedOutput output(dir);
  std::ofstream left;
  job.on_left = [&](const world::LeftPiece& piece) {
    if (piece.outline.parts.empty()) return;
    if (!left.is_open()) left.open(output.add_file("left.jsonl"), std::ios::binary);
    left << world::left_json(piece);
    if (!left.flush()) throw Error((args.out / "left.jsonl").string() + ": cannot be written");
  };
  job.on_planes = [&](int frame, std::span<const unsigned char> png) {
    write_file_bytes(output.add_file(world::planes_file({}, frame)), png);
  };
  job.progress = StageBar("map");
  const world::WorldMap map =
      naming_memory(input.path.string(), [&] { return world::map_recording(job); });
  const std::size_t planes = world::planes_of_map(map.tracker).size();
  const std::vector<world::FrameOfTracks>& frames = map.tracker.frames();
  const auto aside = std::ranges::count(frames, true, &world::FrameOfTracks::set_aside);
  if (planes == 0 || kMostAside * aside > std::ssize(frames)) {
    job.progress = {};
    for (const std::string& line : map.warnings) notice("{}", line);
    if (planes > 0)
      throw Error(fmt::format(
          "{}: not written: {} of {} do not fit the rest; found poses from {}; expected poses for "
          "this recording: T_world_camera in meters, with quaternions as x y z w",
          args.out.string(), aside, counted(frames.size(), "frame"), map.poses.source));
    throw Error(
        fmt::format("{}: not written: no plane was seen in at least {} frames; the input has {}",
                    args.out.string(), map.tracker.options().confirm_frames,
                    counted(input.frames.size(), "frame")));
  }
  write_map(output, map, input.path.filename().string());
  write_meshes(args, job, map, output);
  // What an earlier map has beyond this one is removed.
  for (const fs::path& earlier : files_of_map(dir)) output.add_file(earlier);
  output.commit();
  job.progress = {};
  if (file) {
    file->begin(messages_of(map));
    SegmentArgs segment;
    segment.input = args.input;
    segment.input.inputs = {input.path};
    segment.map = dir;
    segment.quiet = true;
    run_segment(segment, stop, &*file);
  }
  for (const std::string& line : map.warnings) notice("{}", line);
  const auto taken = std::ranges::count_if(map.tracker.frames(), &world::FrameOfTracks::is_in_map);
  const std::string of = taken == std::ssize(input.frames) ? "" : fmt::format("{} of ", taken);
  fmt::print("{}: {} from {}{}, poses of {}\n", args.out.string(), counted(planes, "plane"), of,
             counted(input.frames.size(), "frame"), map.poses.source);
  if (map.pace)
    fmt::print("  {} of {} frames at {:.1f} Hz; latency {:.0f} ms median, {:.0f} ms maximum\n",
               map.pace->taken, map.pace->frames, map.pace->rate_hz,
               1000 * map.pace->behind_s_median, 1000 * map.pace->behind_s_most);
  if (const std::string text = world::stability_text(map.stability); !text.empty())
    fmt::print("  {}\n", text);
  return map.refused > 0 ? 2 : 0;
}

}  // namespace

void define_map(CLI::App& app, Line& line) {
  CLI::App* map = app.add_subcommand(
      "map",
      "Track planes over all frames and build one map of them\n"
      "Writes map.json, tracks.json, poses.tum, and map.png in the world frame: z up, meters. "
      "-o FILE.mcap writes the map and all frames for Foxglove, RViz, and ros2 bag.");
  const auto args = std::make_shared<MapArgs>();
  add_recordings(map, args->input, false, false);
  add_planes_out(map, args->out)->required();
  add(map, "--poses", args->poses, "FILE",
      "Camera poses: TUM, KITTI, or Open3D's .log or .json (default: the recording's, else "
      "odometry)");
  add(map, "--window", args->tracks.window_m, "M",
      "Keep only a cube with this edge in meters around the camera, and write planes that leave it "
      "to left.jsonl (default 0: unlimited)")
      ->check(number(0));
  add(map, "--mesh", args->mesh_voxel_m, "M",
      "Also write mesh.ply: depth of all frames, fused by Open3D (TSDF) in voxels of M meters; "
      "needs a camera without lens distortion")
      ->check(number(0.001, 1));
  map->add_flag("--follow", args->follow,
                "Process frames at the recording's rate and write pace.json; needs poses");
  add_read(
      map, "--shard", [args](const std::string& text) { args->shard = parse_shard(text); }, "I/N",
      "Only find the planes of part I of N of the frames; use the same -o DIR for all parts, then "
      "--join. Needs poses");
  add(map, "--join", args->join, "DIR", "Build the map from the planes that --shard wrote to DIR");
  add_method(map, args->input.pipeline);
  runs(map, line, args, run_map, [args] {
    const bool in_one_pass = args->follow || args->tracks.window_m > 0;
    if (is_planes_file(args->out) && (args->shard || in_one_pass || args->mesh_voxel_m > 0))
      throw Error(
          "map: -o FILE.mcap cannot be combined with --follow, --mesh, --shard, or --window");
    if (args->shard && (in_one_pass || !args->join.empty() || args->mesh_voxel_m > 0))
      throw Error("map: --shard cannot be combined with --follow, --join, --mesh, or --window");
    if (const double m = args->tracks.window_m; m > 0 && m < kLeastWindow_m)
      throw Error(
          fmt::format("--window: {} is out of range; expected 0 (no limit) or at least {} m", m,
                      kLeastWindow_m));
    if (!args->join.empty() && in_one_pass)
      throw Error("map: --join cannot be combined with --follow or --window");
  });
}

}  // namespace planescope::app
