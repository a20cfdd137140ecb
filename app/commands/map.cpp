// planescope map: from frames to a world.

#include <fmt/format.h>

#include <fstream>
#include <mutex>
#include <span>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/map_picture.hpp"
#include "app/commands/report_frames.hpp"
#include "core/io/image/png.hpp"
#include "core/io/surface_fusion.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/world/files/known_map.hpp"
#include "core/world/files/map_files.hpp"
#include "core/world/files/observed_files.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

struct MapArgs {
  InputArgs input;  // one recording
  fs::path out;     // -o
  std::optional<fs::path> poses;
  world::TrackOptions tracks;
  bool follow = false;
  Shard shard;
  fs::path join;            // where shards wrote; empty: none
  double mesh_voxel_m = 0;  // --mesh; 0: no mesh
};

/// "map.png", of the segments after the first "map_1.png".
fs::path file_of_segment(const fs::path& dir,
                         const std::string& name,
                         int segment,
                         const char* type) {
  return dir / (segment == 0 ? name + type : fmt::format("{}_{}{}", name, segment, type));
}

/// DIR/map.json, tracks.json, poses.tum, each whole or not at all.
void write_map(const fs::path& dir, const world::WorldMap& map, const std::string& recording) {
  make_output_dir(dir);
  const world::MapTexts texts = world::map_texts(map, recording);
  write_file_text(dir / "poses.tum", texts.poses_tum);
  write_file_text(dir / "tracks.json", texts.tracks_json);
  write_file_text(dir / "map.json", texts.map_json);
  const int last = std::max(map.poses.poses.back().segment, map.tracker.frames().back().segment);
  for (int segment = 0; segment <= last; ++segment) {
    const Image8 picture = map_from_above(map, segment);
    if (!picture.empty()) io::write_png(file_of_segment(dir, "map", segment, ".png"), picture);
  }
  if (map.pace) write_file_text(dir / "pace.json", world::pace_json(*map.pace));
}

/// DIR/planes/000000.png and so on, written as frames are done, and there once all are; those of an
/// earlier map are removed then.
class PlanesFolder {
 public:
  explicit PlanesFolder(const fs::path& out)
      : dir_(world::planes_file(out, 0).parent_path()), unfinished_(dir_) {
    unfinished_ += ".unfinished";
  }
  ~PlanesFolder() {
    std::error_code absent;
    for (const fs::path& name : names_) fs::remove(unfinished_ / name, absent);
    fs::remove(unfinished_, absent);
  }
  PlanesFolder(const PlanesFolder&) = delete;
  PlanesFolder& operator=(const PlanesFolder&) = delete;

  void operator()(int frame, std::span<const unsigned char> png) {
    if (names_.empty()) make_output_dir(unfinished_);
    names_.push_back(world::planes_file({}, frame).filename());
    write_file_bytes(unfinished_ / names_.back(), png);
  }
  void finish() {
    std::error_code absent, failed;
    std::vector<fs::path> before;
    for (const fs::directory_entry& entry : fs::directory_iterator(dir_, absent))
      if (const std::string stem = entry.path().stem().string();
          entry.path().extension() == ".png" && stem.size() >= 6 &&
          stem.find_first_not_of("0123456789") == std::string::npos)
        before.push_back(entry.path());
    for (const fs::path& file : before) fs::remove(file, absent);
    if (names_.empty()) return;
    make_output_dir(dir_);
    for (const fs::path& name : names_) {
      fs::rename(unfinished_ / name, dir_ / name, failed);
      if (failed) throw Error((dir_ / name).string() + ": cannot be written: " + failed.message());
    }
  }

 private:
  fs::path dir_, unfinished_;
  std::vector<fs::path> names_;
};

/// DIR/left.jsonl, written as pieces leave, and there once all is done; none where nothing did.
class LeftFile {
 public:
  explicit LeftFile(fs::path file) : file_(std::move(file)), unfinished_(file_) {
    unfinished_ += ".unfinished";
  }
  ~LeftFile() {
    std::error_code absent;
    if (out_.is_open()) fs::remove(unfinished_, absent);
  }
  LeftFile(const LeftFile&) = delete;
  LeftFile& operator=(const LeftFile&) = delete;

  void operator()(const world::LeftPiece& piece) {
    if (piece.outline.parts.empty()) return;
    if (!out_.is_open()) {
      make_output_dir(file_.parent_path());
      out_.open(unfinished_, std::ios::binary);
    }
    out_ << world::left_json(piece);
    if (!out_.flush()) throw Error(file_.string() + ": cannot be written");
  }
  /// The file takes the place of an earlier run's, which goes where nothing left.
  void finish() {
    std::error_code failed;
    if (!out_.is_open()) {
      fs::remove(file_, failed);
      return;
    }
    out_.close();
    fs::rename(unfinished_, file_, failed);
    if (failed) throw Error(file_.string() + ": cannot be written: " + failed.message());
  }

 private:
  fs::path file_, unfinished_;
  std::ofstream out_;
};

/// DIR/mesh.ply of each segment, of the frames that went into the map, where it is asked for; those
/// of an earlier map are removed.
void write_meshes(const MapArgs& args, const world::MapJob& job, const world::WorldMap& map) {
  std::error_code absent;
  for (int segment = 0; fs::remove(file_of_segment(args.out, "mesh", segment, ".ply"), absent);
       ++segment) {
  }
  if (!(args.mesh_voxel_m > 0)) return;
  const std::vector<world::FrameOfTracks>& told = map.tracker.frames();
  const auto count = static_cast<int>(told.size());
  std::unique_ptr<io::SurfaceFusion> fusion;
  const auto finish = [&](int segment) {
    const fs::path file = file_of_segment(args.out, "mesh", segment, ".ply");
    if (!fusion || !fusion->write_ply(file))
      notice("{}: not written, there is no surface", file.string());
    fusion.reset();
  };
  for (int i = 0; i < count; ++i) {
    if (job.stop.stop_requested()) throw Cancelled();
    job.progress("mesh", i + 1, count);
    if (i > 0 && told[i].segment != told[i - 1].segment) finish(told[i - 1].segment);
    const world::CameraPose* pose = world::pose_of(map.poses, told[i].frame);
    if (!told[i].has_pose || told[i].set_aside || !pose) continue;
    if (!fusion)
      fusion = io::make_surface_fusion(args.mesh_voxel_m, job.pipeline.cloud.max_range_m);
    fusion->add(job.recording->frame(told[i].frame), pose->T_world_camera);
  }
  finish(told.back().segment);
}

/// Throws what write_meshes() would, before any work is done.
void expect_meshes(const MapArgs& args, const io::RecordingInfo& info) {
  if (!(args.mesh_voxel_m > 0)) return;
  io::make_surface_fusion(args.mesh_voxel_m, 0);
  if (info.intrinsics.distortion != Distortion::none)
    throw Error(info.path.string() +
                ": has lens distortion, which --mesh does not take: Open3D's camera has none");
}

fs::path observed_file(const fs::path& dir, int frame) {
  return dir / "observed" / fmt::format("{:06}.cbor", frame);
}

/// DIR/observed/, a file for each frame of the shard.
void write_shard(const MapArgs& args, const world::MapJob& job) {
  make_output_dir(args.out / "observed");
  std::string key;
  std::size_t written = 0;
  const auto shards = static_cast<std::size_t>(args.shard.count);
  const auto mine = static_cast<std::size_t>(args.shard.index - 1);
  std::vector<std::string> notices;
  world::observe_recording(
      job, [&](std::size_t position) { return position % shards == mine; },
      [&](const world::ObservedFrame& frame, const world::UprightPoses& upright) {
        if (key.empty()) {
          key = world::observed_key(job.pipeline, upright);
          notices = upright.told;
        }
        write_file_bytes(observed_file(args.out, frame.frame), world::observed_bytes(frame, key));
        ++written;
      });
  for (const std::string& line : notices) notice("{}", line);
  fmt::print("{}: {} of shard {}/{}\n", args.out.string(), counted(written, "frame"),
             args.shard.index, args.shard.count);
}

/// Takes frames as shards wrote them.
void join_shards(const fs::path& dir, world::MapJob& job) {
  if (!fs::is_directory(dir / "observed"))
    throw Error(dir.string() + ": holds no folder `observed`, expected what --shard wrote");
  job.observed = [dir, options = job.pipeline, key = std::string(),
                  once = std::make_shared<std::once_flag>()](
                     int frame, const world::UprightPoses& upright) mutable {
    std::call_once(*once, [&] { key = world::observed_key(options, upright); });
    const fs::path file = observed_file(dir, frame);
    if (!fs::exists(file))
      throw Error(file.string() + ": is missing, expected of one of the shards");
    return world::read_observed(file, key);
  };
}

int run_map(const MapArgs& args, std::stop_token stop) {
  if (args.input.inputs.size() > 1)
    throw Error(fmt::format("map takes one recording, {} are given", args.input.inputs.size()));
  if (args.input.pipeline.classifier == "truth")
    throw Error("map: does not take --classifier truth, which knows frames that have labels alone");
  check_output_dir(args.out);
  world::MapJob job;
  if (args.poses) job.trajectory = world::read_trajectory(*args.poses);
  InputArgs input_args = args.input;
  input_args.recording.damaged_frames_later = true;
  const std::vector<OpenInput> inputs = open_inputs(input_args);
  const OpenInput& input = inputs.front();
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);
  job.recording = input.recording.get();
  job.frames = input.frames;
  job.pipeline = args.input.pipeline;
  job.classifier = chosen.classifier.get();
  job.tracks = args.tracks;
  job.threads = args.input.pipeline.threads;
  job.stop = stop;
  job.at_own_rate = args.follow;
  if (args.shard.count > 1) {
    job.progress = StageBar("map");
    write_shard(args, job);
    return 0;
  }
  if (!args.join.empty()) join_shards(args.join, job);
  expect_meshes(args, job.recording->info());
  LeftFile left(args.out / "left.jsonl");
  job.on_left = [&](const world::LeftPiece& piece) { left(piece); };
  PlanesFolder planes_folder(args.out);
  job.on_planes = [&](int frame, std::span<const unsigned char> png) { planes_folder(frame, png); };
  job.progress = StageBar("map");
  const world::WorldMap map = world::map_recording(job);
  planes_folder.finish();
  write_map(args.out, map, input.path.filename().string());
  write_meshes(args, job, map);
  left.finish();
  job.progress = {};
  for (const std::string& line : map.told) notice("{}", line);
  const std::size_t planes = world::planes_of_map(map.tracker).size();
  const auto taken = std::ranges::count_if(
      map.tracker.frames(), [](const auto& frame) { return frame.has_pose && !frame.set_aside; });
  const std::string of = taken == std::ssize(input.frames) ? "" : fmt::format("{} of ", taken);
  fmt::print("{}: {} from {}{}, poses of {}\n", args.out.string(), counted(planes, "plane"), of,
             counted(input.frames.size(), "frame"), map.poses.source);
  if (map.pace)
    fmt::print(
        "  {} of {} frames at {:.1f} a second, in the map {:.0f} ms after they came, {:.0f} "
        "at most\n",
        map.pace->taken, map.pace->frames, map.pace->rate_hz, 1000 * map.pace->behind_s_median,
        1000 * map.pace->behind_s_most);
  if (const std::string text = world::stability_text(map.stability); !text.empty())
    fmt::print("  {}\n", text);
  return map.refused > 0 ? 2 : 0;
}

}  // namespace

void define_map(CLI::App& app, Line& line) {
  CLI::App* map = app.add_subcommand(
      "map",
      "One map of the planes of a recording, and which plane of which frame is which:\n"
      "map.json, tracks.json, poses.tum, map.png. World frame: z up, metres.");
  const auto args = std::make_shared<MapArgs>();
  add_inputs(map, args->input, kOneInput);
  add_out(map, args->out)->required();
  add(map, "--poses", args->poses, "FILE",
      "Where the camera was: TUM, KITTI, or Open3D's .log or .json; else as the recording says, "
      "else from its images");
  add(map, "--window", args->tracks.window_m, "M",
      "Edge of the cube about the camera that the map is held in; what leaves it goes to "
      "left.jsonl. Default 0: no limit")
      ->check(number(0));
  add(map, "--mesh", args->mesh_voxel_m, "M",
      "Also mesh.ply, the frames' depth fused by Open3D (TSDF) in voxels of M metres; of cameras "
      "without lens distortion")
      ->check(number(0.001, 1));
  map->add_flag("--follow", args->follow,
                "Frames come at the recording's own rate; writes pace.json. Needs poses");
  add_read(
      map, "--shard", [args](const std::string& text) { args->shard = parse_shard(text); }, "I/N",
      "Only find the planes of the I-th of N parts of the frames, into -o DIR, the same for all; "
      "--join makes the map of them. Needs poses");
  add(map, "--join", args->join, "DIR", "Take the planes from where --shard wrote them");
  add_method(map, args->input.pipeline);
  runs(map, line, args, run_map, [args] {
    if (args->shard.count > 1 && (args->follow || !args->join.empty() || args->mesh_voxel_m > 0 ||
                                  args->tracks.window_m > 0))
      throw Error("map: --shard goes with none of --follow, --join, --mesh and --window");
  });
}

}  // namespace planescope::app
