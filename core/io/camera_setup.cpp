#include "core/io/camera_setup.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/io/folder/camera_files.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

/// Nominal values; each camera's own differ by a percent or two.
struct Preset {
  const char* name;
  int width, height;
  double f, cx, cy;  // [px]
};
constexpr Preset kPresets[] = {
    {"RealSense D435, D455", 424, 240, 212, 211.5, 119.5},
    {"RealSense D435, D455", 640, 480, 384, 319.5, 239.5},
    {"RealSense D435, D455", 848, 480, 424, 423.5, 239.5},
    {"RealSense D435, D455", 1280, 720, 640, 639.5, 359.5},
    {"RealSense D435, depth aligned to color", 424, 240, 307, 211.5, 119.5},
    {"RealSense D435, depth aligned to color", 640, 480, 615, 319.5, 239.5},
    {"RealSense D435, depth aligned to color", 848, 480, 615, 423.5, 239.5},
    {"RealSense D435, depth aligned to color", 1280, 720, 920, 639.5, 359.5},
    {"Kinect v1, TUM RGB-D", 640, 480, 525, 319.5, 239.5},
    {"Xtion, Structure, Astra (OpenNI)", 640, 480, 570.3, 319.5, 239.5},
    {"Xtion, Structure, Astra (OpenNI)", 320, 240, 285.2, 159.5, 119.5},
    {"Kinect v2", 512, 424, 365.5, 255.5, 211.5},
    {"Azure Kinect, narrow", 640, 576, 504, 319.5, 287.5},
    {"Azure Kinect, narrow, binned", 320, 288, 252, 159.5, 143.5},
    {"Azure Kinect, wide, binned", 512, 512, 252, 255.5, 255.5},
};

constexpr std::size_t kMostFolders = 50;  // searched

bool is_named_calibration(const fs::path& folder) {
  const std::string name = lower_case(folder.filename().string());
  return name.find("calib") != std::string::npos || name.find("intrinsic") != std::string::npos ||
         name.find("camera") != std::string::npos;
}

/// The folder that holds the recording, the folders in the recording, and those beside it whose
/// names speak of calibration: others may be of other recordings.
std::vector<fs::path> folders_near(const fs::path& recording) {
  std::error_code failed;
  const fs::path parent = fs::absolute(path_beside(recording, ""), failed).parent_path();
  std::vector<fs::path> folders;
  for (const fs::path& folder : {recording, parent})
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed))
      if (entry.is_directory(failed) && (folder == recording || is_named_calibration(entry.path())))
        folders.push_back(entry.path());
  std::ranges::sort(folders);
  folders.insert(folders.begin(), parent);
  if (folders.size() > kMostFolders) folders.resize(kMostFolders);
  return folders;
}

}  // namespace

std::vector<CameraChoice> camera_choices(const RecordingInfo& info) {
  std::vector<CameraChoice> choices;
  const auto add = [&](const std::string& name, Intrinsics k, bool from_file) {
    if (k.width > 0 && (k.width != info.width || k.height != info.height)) return;
    if (k.cx >= info.width || k.cy >= info.height) return;
    k.width = info.width;
    k.height = info.height;
    const auto same = [&](const CameraChoice& other) { return other.intrinsics == k; };
    if (std::ranges::none_of(choices, same)) choices.push_back({name, k, from_file});
  };
  const fs::path parent = fs::path(path_beside(info.path, "")).parent_path();
  for (const fs::path& folder : folders_near(info.path)) {
    try {
      const CameraFiles found = find_camera_files(folder);
      if (!found.depth.intrinsics) continue;
      const fs::path file = folder / found.depth.intrinsics_source;
      std::error_code failed;
      const fs::path shown = fs::relative(file, parent.empty() ? "." : parent, failed);
      add((failed ? file : shown).string(), *found.depth.intrinsics, true);
    } catch (const Error&) {
      // Nobody said that this file belongs to the recording.
    }
  }
  for (const Preset& preset : kPresets)
    if (preset.width == info.width && preset.height == info.height)
      add(preset.name, {0, 0, preset.f, preset.f, preset.cx, preset.cy, Distortion::none, {}},
          false);
  return choices;
}

fs::path camera_file(const RecordingInfo& info) { return sidecar_beside(info.path); }

void remember_camera(const RecordingInfo& info) {
  const fs::path file = camera_file(info);
  std::error_code failed;
  nlohmann::ordered_json document = {{"schema", "planescope.recording/1"}};
  if (fs::exists(file, failed)) {
    read_sidecar(info.path);  // throws if it is damaged: it is not ours to repair
    document = read_json<nlohmann::ordered_json>(file);
  }
  document["intrinsics"] = intrinsics_json(info.intrinsics);
  document["depth_unit_m"] = info.depth_unit_m;
  write_file_text(file, json_text(document, 2), Durable::yes);
}

}  // namespace planescope::io
