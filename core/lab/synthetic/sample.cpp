// Writes synthetic recordings with ground truth: the sample, and a walk over stairs.

#include "core/lab/synthetic/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>

#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {

// ---- Common to synthetic folders ----

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSidecar = "planescope.json";

std::string frame_name(std::size_t index) {
  char name[24];
  std::snprintf(name, sizeof(name), "%06zu", index);
  return name;
}

/// Throws Error if a folder contains anything that this sample would not overwrite.
void check_folder(const fs::path& dir, const std::set<std::string>& expected) {
  std::error_code error;
  if (!fs::exists(dir, error)) return;
  if (!fs::is_directory(dir, error)) throw Error(dir.string() + ": is not a folder");
  fs::directory_iterator entries(dir, error);
  if (error) throw Error(dir.string() + ": cannot be read: " + error.message());
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (!expected.contains(name)) {
      throw Error(dir.string() + ": contains " + name +
                  ", which is not part of this sample; expected a new or empty folder");
    }
  }
}

void check_target(const fs::path& dir, const SampleFolder& folder) {
  std::set<std::string> images, labels;
  for (std::size_t i = 0; i < folder.frames; ++i) {
    const std::string name = frame_name(i);
    images.insert(name + ".png");
    for (const char* suffix : {".json", ".plane.png", ".hv.png"}) labels.insert(name + suffix);
  }
  std::set<std::string> content = {kSidecar, "depth"};
  if (folder.color) content.insert("color");
  check_folder(dir, content);
  check_folder(dir / "depth", images);
  if (folder.color) check_folder(dir / "color", images);
  check_folder(labels::default_label_dir(dir), labels);
}

void make_folder(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": folder cannot be created: " + error.message());
}

Json sidecar_of(const SampleFolder& folder, const Frame& first) {
  const Intrinsics& k = first.intrinsics;
  Json json;
  json["schema"] = "planescope.recording/1";
  json["made_by"] = folder.made_by;
  json["seed"] = folder.seed;
  json["intrinsics"] = {
      {"width", k.width}, {"height", k.height},          {"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx},
      {"cy", k.cy},       {"distortion", k.coefficients}};
  json["depth_unit_m"] = first.depth_unit_m;
  json["color_aligned"] = folder.color;
  json["frames"] = Json::array();
  return json;
}

}  // namespace

void write_sample_folder(const fs::path& dir,
                         const SampleFolder& folder,
                         const std::function<SampleFrame(std::size_t)>& make_frame) {
  assert(folder.frames > 0);
  check_target(dir, folder);
  make_folder(dir / "depth");
  if (folder.color) make_folder(dir / "color");

  Json json;
  for (std::size_t i = 0; i < folder.frames; ++i) {
    const std::string name = frame_name(i);
    const SampleFrame sample = make_frame(i);
    const Frame& frame = sample.frame;
    const FrameLabels& truth = sample.truth;
    if (i == 0) json = sidecar_of(folder, frame);
    io::write_png(dir / "depth" / (name + ".png"), frame.depth);
    if (folder.color) io::write_png(dir / "color" / (name + ".png"), frame.color);
    labels::write_frame_labels(labels::default_label_dir(dir), static_cast<int>(i), truth);

    Json entry = {{"name", name},
                  {"scene", sample.scene},
                  {"timestamp_s", sample.timestamp_s.value_or(static_cast<double>(i))}};
    if (folder.gravity || sample.gravity) {
      const Vec3d down = sample.gravity.value_or(truth.gravity.direction);
      entry["gravity"] = {down.x(), down.y(), down.z()};
    }
    if (sample.T_world_camera) entry["T_world_camera"] = io::pose_numbers(*sample.T_world_camera);
    json["frames"].push_back(entry);
  }
  const std::string text = json.dump(1) + "\n";
  write_file_text(dir / kSidecar, text);
}

// ---- The sample ----

namespace {

constexpr int kMinSide = 16, kMaxSide = 8192;
constexpr std::size_t kMaxFrames = 10000;

void check_options(const SampleOptions& options) {
  if (options.scenes.empty() || options.scenes.size() > kMaxFrames) {
    throw Error("synth sample: " + std::to_string(options.scenes.size()) +
                " scenes; expected 1 to " + std::to_string(kMaxFrames));
  }
  for (const std::string& scene : options.scenes) make_scene(scene, options.seed);
  for (const int side : {options.width, options.height}) {
    if (side < kMinSide || side > kMaxSide) {
      throw Error("synth sample: image side of " + std::to_string(side) + " pixels; expected " +
                  std::to_string(kMinSide) + " to " + std::to_string(kMaxSide));
    }
  }
}

}  // namespace

SampleFrame make_sample_frame(const SampleOptions& options, std::size_t index) {
  D435Model model;
  model.intrinsics = d435_intrinsics(options.width, options.height);
  model.noise = options.noise;
  model.color = options.color;
  const std::uint64_t seed = random_bits(options.seed, 0, index);
  const Scene scene = make_scene(options.scenes.at(index), seed);
  SampleFrame sample;
  sample.frame = render_scene(scene, scene.camera, model, seed, &sample.truth);
  sample.scene = scene.name;
  return sample;
}

void write_sample(const std::filesystem::path& dir, const SampleOptions& options) {
  check_options(options);
  const SampleFolder folder{"planescope synth sample", options.seed, options.scenes.size(),
                            options.color, options.gravity};
  write_sample_folder(dir, folder, [&](std::size_t i) { return make_sample_frame(options, i); });
}

// ---- A walk ----

namespace {

constexpr double kImuNoise_deg = 0.3;
constexpr double kWalk_deg = 1.2;     // maximum error from the walk's accelerations
constexpr double kStepRate_hz = 1.6;  // of walking
constexpr double kBob_m = 0.006, kBob_deg = 0.5;
constexpr double kWalk_s = 20;
constexpr int kCovered = 10;

// ---- The world ----

struct Walkway {
  double x = 4, half_width = 0.8, rise = 0.15, going = 0.3, landing = 0.9;
  int steps = 4;
  double top() const { return rise * steps; }
  double landing_begin() const { return x + going * (steps - 1); }  // includes the last tread
  double down() const { return landing_begin() + going + landing; }
  double end() const { return down() + going * (steps - 1); }
};

/// Stairs up along x, a landing, stairs down: solid, each of the two sides one plane.
void add_walkway(Scene& scene, const Walkway& way) {
  const Material concrete{Vec3d(0.6, 0.6, 0.58), Texture::concrete};
  const Range y{-way.half_width, way.half_width};
  int sides[2] = {0, 0};
  const auto column = [&](const Range& x, double z) {
    add_polygon(scene, level(x, y, z), concrete);
    const Range height{0, z};
    sides[0] =
        add_polygon(scene, upright({x.low, y.low}, {x.high, y.low}, height), concrete, sides[0]);
    sides[1] =
        add_polygon(scene, upright({x.high, y.high}, {x.low, y.high}, height), concrete, sides[1]);
  };
  for (int i = 0; i < way.steps; ++i) {
    const double x = way.x + i * way.going, z = i * way.rise;
    add_polygon(scene, upright({x, y.high}, {x, y.low}, {z, z + way.rise}), concrete);
    column({x, i + 1 < way.steps ? x + way.going : way.down()}, z + way.rise);
  }
  for (int i = 0; i < way.steps; ++i) {
    const double x = way.down() + i * way.going, z = way.top() - (i + 1) * way.rise;
    add_polygon(scene, upright({x, y.low}, {x, y.high}, {z, z + way.rise}), concrete);
    if (i + 1 < way.steps) column({x, x + way.going}, z);
  }
}

double varied(std::uint64_t seed, std::uint64_t stream, double value) {
  return value * (1 + 0.04 * (2 * random_uniform(seed, stream, 0) - 1));
}

/// `with_box`: include the removable box.
Scene make_world(std::uint64_t seed, const Walkway& way, bool with_box) {
  Scene scene;
  scene.name = "walk";
  const Range x{-1.5, way.end() + 3}, y{-2.2, 2.2};
  const Footprint stairs{{way.x, way.end()}, {-way.half_width, way.half_width}};
  // Like on a real floor, the grain shows the motion.
  add_ground(scene, {x, y}, std::span(&stairs, 1), {Vec3d(0.52, 0.51, 0.48), Texture::concrete});
  add_walkway(scene, way);
  add_box(scene, {1.7, -1.0, 0}, {varied(seed, 1, 3.6), 0.35, varied(seed, 2, 0.12)}, 0,
          {Vec3d(0.7, 0.68, 0.62), Texture::concrete});
  const Material board{Vec3d(0.62, 0.45, 0.28), Texture::cardboard};
  add_box(scene, {1.1, 0.85, 0}, {0.45, 0.35, varied(seed, 3, 0.25)}, 20, board);
  add_box(scene, {2.1, 1.05, 0}, {0.5, 0.4, varied(seed, 4, 0.42)}, -15, board);
  const Material brick{Vec3d(0.6, 0.35, 0.3), Texture::brick};
  add_polygon(scene, upright({x.low, y.high}, {x.high, y.high}, {0, 2.2}), brick);
  add_polygon(scene, upright({x.high, y.high}, {x.high, y.low}, {0, 2.2}), brick);
  // The last one, so that all others keep their ids without it.
  if (with_box) add_box(scene, {3.1, 0.55, 0}, {0.4, 0.35, varied(seed, 5, 0.3)}, 35, board);
  return scene;
}

// ---- The camera's path ----

struct WayPoint {
  double x = 0, y = 0, ground = 0, yaw_deg = 0, pitch_deg = 32;
};

/// Catmull-Rom curve through four values.
double curve(double a, double b, double c, double d, double t) {
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

WayPoint on_way(std::span<const WayPoint> way, double share) {
  const double at = share * static_cast<double>(way.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), way.size() - 2);
  const double t = at - static_cast<double>(i);
  const WayPoint &b = way[i], &c = way[i + 1];
  const WayPoint& a = way[i > 0 ? i - 1 : i];
  const WayPoint& d = way[std::min(i + 2, way.size() - 1)];
  const auto mixed = [&](double WayPoint::*value) {
    return curve(a.*value, b.*value, c.*value, d.*value, t);
  };
  return {mixed(&WayPoint::x), mixed(&WayPoint::y), mixed(&WayPoint::ground),
          mixed(&WayPoint::yaw_deg), mixed(&WayPoint::pitch_deg)};
}

/// Equally spaced in time.
std::vector<WayPoint> way_points(const Walkway& w) {
  const double middle = (w.landing_begin() + w.down()) / 2, top = w.top(), end = w.end();
  return {{-0.4, 0, 0, 0, 32},
          {0.3, 0, 0, 20, 30},
          {1.0, -0.1, 0, 10, 32},
          {1.7, -0.1, 0, -20, 30},
          {2.4, 0, 0, 0, 30},
          {3.1, 0, 0, 5, 32},
          {w.x, 0, 0.3 * top, 0, 30},
          {w.x + 0.6, 0, 0.7 * top, 0, 32},
          {middle, 0, top, 0, 34},
          {w.down(), 0, 0.9 * top, 0, 38},
          {end - 0.3, 0, 0.4 * top, 0, 36},
          {end + 0.5, 0, 0, 0, 30},
          {end + 1.1, 0, 0, 35, 28},
          {end + 1.4, 0.1, 0, 80, 28},
          {end + 1.4, 0.1, 0, 125, 30},
          {end + 1.2, 0.1, 0, 165, 32},
          {end + 0.9, 0, 0, 182, 32}};
}

std::vector<CameraPose> cameras_of(const SequenceOptions& options, const Walkway& way) {
  const std::vector<WayPoint> points = way_points(way);
  std::vector<CameraPose> cameras;
  for (int i = 0; i < options.frames; ++i) {
    const double share = options.frames > 1 ? static_cast<double>(i) / (options.frames - 1) : 0;
    const WayPoint at = on_way(points, share);
    const double turn = 360 * kStepRate_hz * kWalk_s * share;
    CameraPose& camera = cameras.emplace_back();
    camera.position = Vec3d(at.x, at.y, at.ground + 0.8 + kBob_m * sin_deg(turn));
    camera.yaw_deg = at.yaw_deg;
    camera.pitch_deg = at.pitch_deg + kBob_deg * cos_deg(turn);
    camera.roll_deg = kBob_deg * sin_deg(turn / 2);
  }
  return cameras;
}

/// Gravity as measured by a walking camera's accelerometer.
Vec3d measured_gravity(const SequenceOptions& options, const Vec3d& down, std::size_t index) {
  const double share = static_cast<double>(index) / std::max(1, options.frames - 1);
  const double turn = 360 * kStepRate_hz * kWalk_s * share;
  const auto noise = [&](std::uint64_t axis) {
    return kImuNoise_deg * random_normal(options.seed, 77 + axis, index);
  };
  return (rotation(Vec3d::UnitX(), kWalk_deg * sin_deg(turn) + noise(0)) *
          rotation(Vec3d::UnitZ(), noise(1)) * down)
      .normalized();
}

}  // namespace

Sequence make_sequence(const SequenceOptions& options) {
  constexpr int kMostFrames = 100000;
  if (options.frames < 2 || options.frames > kMostFrames)
    throw Error(
        fmt::format("synth sequence: {} frames; expected 2 to {}", options.frames, kMostFrames));
  Walkway way;
  way.rise = varied(options.seed, 10, way.rise);
  way.going = varied(options.seed, 11, way.going);
  Sequence sequence;
  sequence.scene = make_world(options.seed, way, true);
  sequence.change = static_cast<std::size_t>(options.frames);
  if (options.moved) {
    // After the removal, the camera still sees the box's place.
    sequence.later = make_world(options.seed, way, false);
    sequence.later.planes = sequence.scene.planes;
    sequence.change = static_cast<std::size_t>(options.frames) * 22 / 100;
  }
  sequence.cameras = cameras_of(options, way);
  return sequence;
}

SampleFrame make_sequence_frame(const SequenceOptions& options,
                                const Sequence& sequence,
                                std::size_t index) {
  D435Model model;
  model.intrinsics = d435_intrinsics(options.width, options.height);
  model.noise = options.noise;
  model.color = options.color;
  const Scene& scene = sequence.scene_of(index);
  const CameraPose& camera = sequence.cameras.at(index);
  SampleFrame sample;
  sample.frame =
      render_scene(scene, camera, model, random_bits(options.seed, 1, index), &sample.truth);
  sample.scene = scene.name;
  sample.T_world_camera = pose_of(camera);
  sample.timestamp_s = static_cast<double>(index) / options.rate_hz;
  sample.frame.timestamp_s = *sample.timestamp_s;
  sample.frame.index = static_cast<int>(index);
  if (options.imu)
    sample.gravity = measured_gravity(options, sample.truth.gravity.direction, index);
  const std::size_t middle = sequence.cameras.size() / 2;
  if (options.covered && index >= middle && index < middle + kCovered)
    std::ranges::fill(sample.frame.depth.data, std::uint16_t{0});
  return sample;
}

void write_sequence(const std::filesystem::path& dir,
                    const SequenceOptions& options,
                    int threads,
                    const std::function<void(int done, int all)>& progress) {
  const Sequence sequence = make_sequence(options);
  SampleFolder folder{"planescope synth sequence", options.seed, sequence.cameras.size(),
                      options.color, false};
  // Frames are generated in small parallel batches.
  std::vector<SampleFrame> made;
  std::size_t first = 0;
  write_sample_folder(dir, folder, [&](std::size_t i) {
    if (i >= first + made.size()) {
      first = i;
      made.assign(std::min<std::size_t>(4 * threads, sequence.cameras.size() - i), {});
      work_through(static_cast<int>(made.size()), threads,
                   [&](int k) { made[k] = make_sequence_frame(options, sequence, first + k); });
    }
    if (progress) progress(static_cast<int>(i) + 1, options.frames);
    return std::move(made[i - first]);
  });
}

}  // namespace planescope::lab
