#include <algorithm>
#include <map>
#include <pugixml.hpp>

#include "core/io/cloud_files/cloud_builder.hpp"
#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/folder/camera_files.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxXmlBytes = 1 << 20;

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  WordReader words(std::as_bytes(std::span(text)));
  try {
    while (true) {
      std::string_view word = words.next();
      if (word.ends_with('.')) word.remove_suffix(1);
      const auto value = parse_number(word);
      if (!value) return {};
      numbers.push_back(*value);
    }
  } catch (OutOfBytes) {
    return numbers;
  }
}

using Matrices = std::map<std::string, std::vector<double>>;

/// The matrices that OpenCV's FileStorage writes, by name: an element <NAME
/// type_id="opencv-matrix"> with <rows>, <cols> and <data>. Of equal names the first.
Matrices matrices_in(const pugi::xml_document& document) {
  Matrices matrices;
  for (const pugi::xpath_node& found : document.select_nodes("//*[@type_id='opencv-matrix'][data]"))
    matrices.emplace(found.node().name(), numbers_in(found.node().child_value("data")));
  return matrices;
}

bool is_camera_matrix(const std::vector<double>& m) {
  return m.size() == 9 && m[0] > 1 && m[4] > 1 && m[1] == 0 && m[3] == 0 && m[6] == 0 &&
         m[7] == 0 && m[8] == 1;
}

bool has_word(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

constexpr std::initializer_list<const char*> kDepthNames = {"IR", "Depth", "depth"};
constexpr std::initializer_list<const char*> kColorNames = {"RGB", "Color", "color", "rgb"};

/// Intrinsics under a name with one of the words (any name where there are none), with the
/// distortion coefficients of the same words.
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

/// Rotation and translation (millimetres, as OpenCV calibrations of depth cameras have them).
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
  std::error_code ignored;
  if (fs::file_size(path, ignored) > kMaxXmlBytes) return std::nullopt;
  const auto bytes = read_file_bytes(path, kMaxXmlBytes);
  pugi::xml_document document;
  if (!document.load_buffer(bytes.data(), bytes.size())) return std::nullopt;
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

}  // namespace planescope::io
