#include "core/synthetic/sample.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "core/base/error.hpp"
#include "core/base/file_bytes.hpp"
#include "core/image/png.hpp"
#include "core/labels/label_files.hpp"
#include "core/synthetic/counter_random.hpp"
#include "core/synthetic/render_scene.hpp"
#include "core/synthetic/scenes.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSidecar = "planescope.json";
constexpr int kMinSide = 16, kMaxSide = 8192;
constexpr std::size_t kMaxFrames = 10000;

std::string frame_name(std::size_t index) {
  char name[24];
  std::snprintf(name, sizeof(name), "%06zu", index);
  return name;
}

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

void check_target(const fs::path& dir, const SampleOptions& options) {
  std::set<std::string> images, labels;
  for (std::size_t i = 0; i < options.scenes.size(); ++i) {
    const std::string name = frame_name(i);
    images.insert(name + ".png");
    for (const char* suffix : {".json", ".plane.png", ".hv.png"}) labels.insert(name + suffix);
  }
  std::set<std::string> content = {kSidecar, "depth"};
  if (options.color) content.insert("color");
  check_folder(dir, content);
  check_folder(dir / "depth", images);
  if (options.color) check_folder(dir / "color", images);
  check_folder(default_label_dir(dir), labels);
}

void make_folder(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": cannot be made a folder: " + error.message());
}

Json sidecar_of(const D435Model& model, const SampleOptions& options) {
  const Intrinsics& k = model.intrinsics;
  Json json;
  json["schema"] = "planescope.recording/1";
  json["made_by"] = "planescope synth sample";
  json["seed"] = options.seed;
  json["intrinsics"] = {
      {"width", k.width}, {"height", k.height},          {"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx},
      {"cy", k.cy},       {"distortion", k.coefficients}};
  json["depth_unit_m"] = model.depth_unit_m;
  json["color_aligned"] = model.color;
  json["frames"] = Json::array();
  return json;
}

}  // namespace

void write_sample(const fs::path& dir, const SampleOptions& options) {
  check_options(options);
  check_target(dir, options);
  make_folder(dir / "depth");
  if (options.color) make_folder(dir / "color");

  D435Model model;
  model.intrinsics = d435_intrinsics(options.width, options.height);
  model.noise = options.noise;
  model.color = options.color;
  Json json = sidecar_of(model, options);
  for (std::size_t i = 0; i < options.scenes.size(); ++i) {
    const std::string name = frame_name(i);
    const std::uint64_t seed = random_bits(options.seed, 0, i);
    const Scene scene = make_scene(options.scenes[i], seed);
    FrameLabels truth;
    const Frame frame = render_scene(scene, scene.camera, model, seed, &truth);
    write_png(dir / "depth" / (name + ".png"), frame.depth);
    if (options.color) write_png(dir / "color" / (name + ".png"), frame.color);
    write_frame_labels(default_label_dir(dir), static_cast<int>(i), truth);

    Json entry = {{"name", name}, {"scene", scene.name}, {"timestamp_s", static_cast<double>(i)}};
    if (options.gravity) {
      const Vec3d& down = truth.gravity.direction;
      entry["gravity"] = {down.x(), down.y(), down.z()};
    }
    json["frames"].push_back(entry);
  }
  const std::string text = json.dump(1) + "\n";
  write_file_bytes(dir / kSidecar,
                   std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

}  // namespace planescope
