// Calibration files beside images, and nominal values of common cameras.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/io/folder/folder_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t kMaxTextBytes = 1 << 16;
constexpr std::uintmax_t kMaxJsonBytes = 1 << 20;  // also for XML

bool has_word(const std::string& text, std::initializer_list<const char*> words) {
  return std::ranges::any_of(
      words, [&](const char* word) { return text.find(word) != std::string::npos; });
}
bool name_has(const fs::path& path, std::initializer_list<const char*> words) {
  return has_word(path.filename().string(), words);
}

/// The numbers of `intrinsic_matrix`: a row of nine, or three rows of three.
std::vector<double> matrix_numbers(const json& value) {
  std::vector<double> numbers;
  if (!value.is_array()) return numbers;
  for (const json& entry : value) {
    if (entry.is_number()) numbers.push_back(entry.get<double>());
    if (!entry.is_array()) continue;
    for (const json& inner : entry) {
      if (inner.is_number()) numbers.push_back(inner.get<double>());
    }
  }
  return numbers;
}

std::optional<Intrinsics> json_intrinsics(const json& object, const fs::path& path) {
  Intrinsics k;
  const auto has_numbers = [&](std::initializer_list<const char*> keys) {
    return std::ranges::all_of(
        keys, [&](const char* key) { return object.contains(key) && object[key].is_number(); });
  };
  const auto number = [&](const char* key) { return object.at(key).get<double>(); };
  if (object.contains("intrinsic_matrix")) {
    const json& matrix = object["intrinsic_matrix"];
    const auto m = matrix_numbers(matrix);
    if (m.size() != 9)
      throw Error(fmt::format("{}: \"intrinsic_matrix\" has {} numbers; expected 9", path.string(),
                              m.size()));
    // Open3D stores the matrix column by column. Three rows of three, and a matrix with its
    // principal point in the first row, are stored row by row.
    const bool rows = matrix[0].is_array() || (m[6] == 0 && m[2] != 0);
    k.fx = m[0], k.fy = m[4], k.cx = rows ? m[2] : m[6], k.cy = rows ? m[5] : m[7];
  } else {
    const bool by_c = has_numbers({"fx", "fy", "cx", "cy"});
    if (!by_c && !has_numbers({"fx", "fy", "ppx", "ppy"})) return std::nullopt;
    k.fx = number("fx"), k.fy = number("fy");
    k.cx = number(by_c ? "cx" : "ppx"), k.cy = number(by_c ? "cy" : "ppy");
  }
  k.fy = std::abs(k.fy);
  if (has_numbers({"width", "height"})) {
    k.width = static_cast<int>(std::clamp(number("width"), 0.0, 1e5));
    k.height = static_cast<int>(std::clamp(number("height"), 0.0, 1e5));
  }
  return k;
}

/// nullopt if the file is larger.
std::optional<std::string> small_text(const fs::path& path, std::uintmax_t most_bytes) {
  std::error_code ignored;
  if (fs::file_size(path, ignored) > most_bytes) return std::nullopt;
  const auto bytes = read_file_bytes(path, most_bytes);
  return std::string(bytes.begin(), bytes.end());
}

std::vector<fs::path> files_of(const fs::path& folder, std::initializer_list<const char*> kinds) {
  std::vector<fs::path> files = files_in(folder);
  std::erase_if(
      files, [&](const fs::path& path) { return std::ranges::count(kinds, extension(path)) == 0; });
  return files;
}

/// All numbers of a text; nullopt if it contains anything else, or more than `most` numbers.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t most) {
  std::vector<double> numbers;
  for (const TextLine& line : text_lines(text))
    for (std::string_view word : line.words) {
      // ICL-NUIM's files and OpenCV write "0." and "-480.0".
      if (word.ends_with('.')) word.remove_suffix(1);
      const auto value = parse_number(word);
      if (!value || !std::isfinite(*value) || numbers.size() == most) return std::nullopt;
      numbers.push_back(*value);
    }
  return numbers;
}

struct Candidate {
  fs::path path;
  CameraFacts facts;
};

/// Chooses the files for depth and for color by their names.
CameraFiles choose(const std::vector<Candidate>& candidates) {
  const auto find = [&](auto wanted) {
    return std::find_if(candidates.begin(), candidates.end(),
                        [&](const Candidate& c) { return wanted(c.path); });
  };
  const auto is_color = [](const fs::path& p) { return name_has(p, {"color", "rgb"}); };
  auto depth = find([](const fs::path& p) { return name_has(p, {"depth"}); });
  const std::string usual[] = {"intrinsic.json", "camera_intrinsic.json"};
  for (const std::string& name : usual) {
    if (depth == candidates.end())
      depth = find([&](const fs::path& p) { return p.filename() == name; });
  }
  if (depth == candidates.end()) depth = find([&](const fs::path& p) { return !is_color(p); });
  if (depth == candidates.end()) depth = candidates.begin();
  CameraFiles files;
  files.depth = depth->facts;
  const auto color = find(is_color);
  if (color != candidates.end() && color != depth) files.color = color->facts.intrinsics;
  return files;
}

}  // namespace

std::optional<CameraFacts> camera_from_json(const fs::path& path) {
  std::error_code ignored;
  if (fs::file_size(path, ignored) > kMaxJsonBytes) return std::nullopt;
  json document;
  try {
    document = read_json<nlohmann::json>(path);
  } catch (const Error&) {
    if (name_has(path, {"intrinsic"})) throw;
    return std::nullopt;
  }
  if (!document.is_object()) return std::nullopt;
  const bool nested = document.contains("intrinsic") && document["intrinsic"].is_object();
  const auto intrinsics = json_intrinsics(nested ? document["intrinsic"] : document, path);
  if (!intrinsics) return std::nullopt;
  CameraFacts facts;
  facts.intrinsics = intrinsics;
  facts.intrinsics_source = path.filename().string();
  if (document.contains("depth_scale") && document["depth_scale"].is_number()) {
    // RealSense writes meters per count (0.001), Open3D counts per meter (1000).
    const double scale = document["depth_scale"].get<double>();
    if (scale > 0) {
      facts.depth_unit_m = scale >= 1 ? 1 / scale : scale;
      facts.depth_unit_source = path.filename().string() + " depth_scale " +
                                (scale >= 1 ? "(counts per meter)" : "(meters per count)");
    }
  }
  return facts;
}

std::optional<CameraFacts> camera_from_text(const fs::path& path) {
  auto text = small_text(path, kMaxTextBytes);
  if (!text) return std::nullopt;
  std::ranges::replace(*text, ',', ' ');
  const auto numbers = numbers_in(*text, 17);
  if (!numbers) return std::nullopt;
  const std::vector<double>& n = *numbers;
  const auto is_matrix = [&](std::size_t stride) {
    return n[1] == 0 && n[stride] == 0 && n[2 * stride] == 0 && n[2 * stride + 1] == 0 &&
           n[2 * stride + 2] == 1;
  };
  const auto is_whole = [](double pixels) {
    return pixels >= 1 && pixels <= 1e5 && pixels == std::floor(pixels);
  };
  CameraFacts facts;
  Intrinsics k;
  const auto take = [&](std::size_t fy, std::size_t cx, std::size_t cy) {
    // A negative fy (ICL-NUIM) flips the image's y axis; the depth itself has y down as ours.
    k.fx = n[0], k.fy = std::abs(n[fy]), k.cx = n[cx], k.cy = n[cy];
  };
  if (n.size() == 4) {
    take(1, 2, 3);
  } else if (n.size() == 7 && is_whole(n[5]) && is_whole(n[6]) && n[4] > 0 && n[4] <= 1) {
    take(1, 2, 3);
    k.width = static_cast<int>(n[5]);
    k.height = static_cast<int>(n[6]);
    facts.depth_unit_m = n[4];
    facts.depth_unit_source = path.filename().string();
  } else if (n.size() == 9 && is_matrix(3)) {
    take(4, 2, 5);
  } else if (n.size() == 16 && is_matrix(4)) {
    take(5, 2, 6);
  } else {
    return std::nullopt;
  }
  if (k.fx < 1 || k.fy < 1) return std::nullopt;
  facts.intrinsics = k;
  facts.intrinsics_source = path.filename().string();
  return facts;
}

namespace {

CameraFiles understood_files(const fs::path& folder) {
  std::vector<Candidate> candidates;
  for (const fs::path& path : files_of(folder, {".json"})) {
    if (name_has(path, {"planescope.json", "gravity.json"})) continue;
    if (auto facts = camera_from_json(path)) candidates.push_back({path, *facts});
  }
  if (!candidates.empty()) return choose(candidates);
  for (const fs::path& path : files_of(folder, {".xml"})) {
    if (auto files = camera_from_opencv_xml(path)) return *files;
  }
  for (const fs::path& path : files_of(folder, {".k", ".txt", ".intrinsics"})) {
    if (auto facts = camera_from_text(path)) candidates.push_back({path, *facts});
  }
  if (!candidates.empty()) return choose(candidates);
  return {};
}

bool is_understood(const fs::path& path) {
  try {
    const std::string kind = extension(path);
    if (kind == ".json") return camera_from_json(path).has_value();
    if (kind == ".xml") return camera_from_opencv_xml(path).has_value();
    return (kind == ".k" || kind == ".txt" || kind == ".intrinsics") &&
           camera_from_text(path).has_value();
  } catch (const Error&) {
    return false;
  }
}

/// Whether the name is that of a calibration: "calib.yaml", "camera_info.txt".
bool is_named_calibration_file(const fs::path& path) {
  constexpr std::string_view kKinds =
      ".cfg.conf.csv.ini.intrinsics.json.npy.npz.toml.txt.xml.yaml.yml";
  const std::string name = lower_case(path.stem().string());
  return kKinds.find(extension(path)) != kKinds.npos &&
         (has_word(name, {"calib", "intrinsic", "camera_info"}) || name == "camera");
}

}  // namespace

CameraFiles find_camera_files(const fs::path& folder) {
  CameraFiles files = understood_files(folder);
  for (const fs::path& path : files_in(folder))
    if (is_named_calibration_file(path) && !is_understood(path))
      files.ignored.push_back(path.filename().string());
  return files;
}

namespace {

using Matrices = std::map<std::string, std::vector<double>>;

/// The matrices in a file of OpenCV's FileStorage, by name: an element <NAME
/// type_id="opencv-matrix"> with <rows>, <cols> and <data>. For equal names, the first.
Matrices matrices_in(const pugi::xml_document& document) {
  Matrices matrices;
  for (const pugi::xpath_node& found : document.select_nodes("//*[@type_id='opencv-matrix'][data]"))
    matrices.emplace(found.node().name(),
                     numbers_in(found.node().child_value("data"), kMaxJsonBytes)
                         .value_or(std::vector<double>()));
  return matrices;
}

bool is_camera_matrix(const std::vector<double>& m) {
  return m.size() == 9 && m[0] > 1 && m[4] > 1 && m[1] == 0 && m[3] == 0 && m[6] == 0 &&
         m[7] == 0 && m[8] == 1;
}

constexpr std::initializer_list<const char*> kDepthNames = {"IR", "Depth", "depth"};
constexpr std::initializer_list<const char*> kColorNames = {"RGB", "Color", "color", "rgb"};

/// The intrinsics whose name contains one of the words (any name if there are no words), and the
/// distortion coefficients with the same words.
std::optional<Intrinsics> intrinsics_of(const Matrices& matrices,
                                        std::initializer_list<const char*> words) {
  const auto wanted = [&](const std::string& name) {
    return words.size() == 0 || has_word(name, words);
  };
  for (const auto& [name, m] : matrices) {
    if (!wanted(name) || !is_camera_matrix(m)) continue;
    Intrinsics k{0, 0, m[0], m[4], m[2], m[5], Distortion::none, {}};
    for (const auto& [other, coefficients] : matrices) {
      if (wanted(other) && has_word(other, {"istortion"}) && coefficients.size() >= 4) {
        set_distortion("brown_conrady", coefficients, k);
      }
    }
    return k;
  }
  return std::nullopt;
}

/// Rotation and translation (millimeters, as in OpenCV calibrations of depth cameras).
std::optional<Pose> stereo_pose(const Matrices& matrices) {
  const auto rotation = matrices.find("Rotation");
  const auto translation = matrices.find("Translation");
  if (rotation == matrices.end() || rotation->second.size() != 9 || translation == matrices.end() ||
      translation->second.size() != 3) {
    return std::nullopt;
  }
  Mat3d r;
  for (int i = 0; i < 9; ++i) r(i / 3, i % 3) = rotation->second[i];
  if (!(r * r.transpose()).isIdentity(1e-2) || r.determinant() < 0) return std::nullopt;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  pose.translation() = 1e-3 * Vec3d::Map(translation->second.data());
  return pose;
}

}  // namespace

std::optional<CameraFiles> camera_from_opencv_xml(const fs::path& path) {
  const auto text = small_text(path, kMaxJsonBytes);
  pugi::xml_document document;
  if (!text || !document.load_buffer(text->data(), text->size())) return std::nullopt;
  const Matrices matrices = matrices_in(document);
  CameraFiles files;
  files.depth.intrinsics = intrinsics_of(matrices, kDepthNames);
  if (files.depth.intrinsics) {
    files.color = intrinsics_of(matrices, kColorNames);
    if (files.color) files.T_color_depth = stereo_pose(matrices);
  } else {
    files.depth.intrinsics = intrinsics_of(matrices, {});
  }
  if (!files.depth.intrinsics) return std::nullopt;
  files.depth.intrinsics_source = path.filename().string();
  return files;
}

namespace {

/// Nominal values; each camera differs from them by a percent or two.
struct Preset {
  const char* name;
  int width, height;
  double f, cx, cy;             // [px]
  double depth_unit_m = 0.001;  // meters per count
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
    {"Kinect v1 (OpenNI)", 640, 480, 525, 319.5, 239.5},
    {"TUM RGB-D", 640, 480, 525, 319.5, 239.5, 0.0002},
    {"Xtion, Structure, Astra (OpenNI)", 640, 480, 570.3, 319.5, 239.5},
    {"Xtion, Structure, Astra (OpenNI)", 320, 240, 285.2, 159.5, 119.5},
    {"Kinect v2", 512, 424, 365.5, 255.5, 211.5},
    {"Azure Kinect, narrow", 640, 576, 504, 319.5, 287.5},
    {"Azure Kinect, narrow, binned", 320, 288, 252, 159.5, 143.5},
    {"Azure Kinect, wide, binned", 512, 512, 252, 255.5, 255.5},
};

constexpr std::size_t kMostFolders = 50;  // to search

bool is_named_calibration(const fs::path& folder) {
  const std::string name = lower_case(folder.filename().string());
  return name.find("calib") != std::string::npos || name.find("intrinsic") != std::string::npos ||
         name.find("camera") != std::string::npos;
}

/// The folder that contains the recording, the folders in the recording, and those beside it with a
/// name for calibration. Others may belong to other recordings.
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
  const auto add = [&](const std::string& name, Intrinsics k, bool from_file, double unit_m) {
    if (k.width > 0 && (k.width != info.width || k.height != info.height)) return;
    if (k.cx >= info.width || k.cy >= info.height) return;
    k.width = info.width;
    k.height = info.height;
    const auto same = [&](const CameraChoice& other) {
      return other.intrinsics == k && other.depth_unit_m == unit_m;
    };
    if (std::ranges::none_of(choices, same)) choices.push_back({name, k, unit_m, from_file});
  };
  const fs::path parent = fs::path(path_beside(info.path, "")).parent_path();
  for (const fs::path& folder : folders_near(info.path)) {
    try {
      const CameraFiles found = find_camera_files(folder);
      if (!found.depth.intrinsics) continue;
      const fs::path file = folder / found.depth.intrinsics_source;
      std::error_code failed;
      const fs::path shown = fs::relative(file, parent.empty() ? "." : parent, failed);
      add((failed ? file : shown).string(), *found.depth.intrinsics, true,
          found.depth.depth_unit_m.value_or(info.depth_unit_m));
    } catch (const Error&) {
      // Damaged, but it may not belong to this recording at all.
    }
  }
  for (const Preset& preset : kPresets)
    if (preset.width == info.width && preset.height == info.height)
      add(preset.name, {0, 0, preset.f, preset.f, preset.cx, preset.cy, Distortion::none, {}},
          false, preset.depth_unit_m);
  return choices;
}

std::string nominal_camera(const Intrinsics& k) {
  for (const Preset& p : kPresets)
    if (k.width == p.width && k.height == p.height && k.fx == p.f && k.fy == p.f && k.cx == p.cx &&
        k.cy == p.cy)
      return p.name;
  return "";
}

fs::path camera_file(const RecordingInfo& info) { return sidecar_beside(info.path); }

void remember_camera(const RecordingInfo& info) {
  const fs::path file = camera_file(info);
  std::error_code failed;
  nlohmann::ordered_json document = {{"schema", "planescope.recording/1"}};
  if (fs::exists(file, failed)) {
    read_sidecar(info.path);  // throws if it is damaged: never repair the user's file
    document = read_json<nlohmann::ordered_json>(file);
  }
  document["intrinsics"] = intrinsics_json(info.intrinsics);
  document["depth_unit_m"] = info.depth_unit_m;
  write_file_text(file, json_text(document, 2), Durable::yes);
}

}  // namespace planescope::io
