#include "core/lab/synthetic/sample.hpp"

#include <cassert>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {

// ---- Any synthetic folder ----

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSidecar = "planescope.json";

std::string frame_name(std::size_t index) {
  char name[24];
  std::snprintf(name, sizeof(name), "%06zu", index);
  return name;
}

/// Throws Error if a folder holds anything that this sample would not overwrite.
void check_folder(const fs::path& dir, const std::set<std::string>& expected) {
  std::error_code error;
  if (!fs::exists(dir, error)) return;
  if (!fs::is_directory(dir, error)) throw Error(dir.string() + ": exists and is not a folder");
  fs::directory_iterator entries(dir, error);
  if (error) throw Error(dir.string() + ": cannot be read: " + error.message());
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (!expected.contains(name)) {
      throw Error(dir.string() + ": holds " + name +
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
  if (error) throw Error(dir.string() + ": cannot be made a folder: " + error.message());
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
                " scenes, expected 1 to " + std::to_string(kMaxFrames));
  }
  for (const std::string& scene : options.scenes) make_scene(scene, options.seed);
  for (const int side : {options.width, options.height}) {
    if (side < kMinSide || side > kMaxSide) {
      throw Error("synth sample: " + std::to_string(side) + " pixels, expected " +
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

}  // namespace planescope::lab
