#include <algorithm>
#include <map>

#include "core/io/cloud_files/cloud_builder.hpp"
#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/folder/camera_files.hpp"
#include "core/model/file_bytes.hpp"

// The matrices that OpenCV's FileStorage writes as XML, read without an XML library: an element
// <NAME type_id="opencv-matrix"> with <rows>, <cols> and <data>.
namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxBytes = 1 << 20;

/// The text between <tag> and </tag> in `text`, from `from` on.
std::optional<std::string_view> content(std::string_view text, std::string_view tag) {
  const std::string open = std::string("<").append(tag).append(">");
  const std::size_t start = text.find(open);
  if (start == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find(std::string("</").append(tag).append(">"), start);
  if (end == std::string_view::npos) return std::nullopt;
  return text.substr(start + open.size(), end - start - open.size());
}

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

std::map<std::string, std::vector<double>> matrices_in(std::string_view xml) {
  std::map<std::string, std::vector<double>> matrices;
  constexpr std::string_view kMark = " type_id=\"opencv-matrix\"";
  for (std::size_t at = xml.find(kMark); at != std::string_view::npos;
       at = xml.find(kMark, at + 1)) {
    const std::size_t open = xml.rfind('<', at);
    if (open == std::string_view::npos) continue;
    const std::string name(xml.substr(open + 1, at - open - 1));
    const std::size_t end = xml.find(std::string("</").append(name).append(">"), at);
    const auto data =
        content(xml.substr(at, end == std::string_view::npos ? end : end - at), "data");
    if (data) matrices.emplace(name, numbers_in(*data));
  }
  return matrices;
}

bool is_camera_matrix(const std::vector<double>& m) {
  return m.size() == 9 && m[0] > 1 && m[4] > 1 && m[1] == 0 && m[3] == 0 && m[6] == 0 &&
         m[7] == 0 && m[8] == 1;
}

bool contains(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

constexpr std::initializer_list<const char*> kDepthNames = {"IR", "Depth", "depth"};
constexpr std::initializer_list<const char*> kColorNames = {"RGB", "Color", "color", "rgb"};

/// Intrinsics under a name with one of the words (any name where there are none), with the
/// distortion coefficients of the same words.
std::optional<Intrinsics> intrinsics_of(const std::map<std::string, std::vector<double>>& matrices,
                                        std::initializer_list<const char*> words) {
  const auto wanted = [&](const std::string& name) {
    return words.size() == 0 || contains(name, words);
  };
  for (const auto& [name, m] : matrices) {
    if (!wanted(name) || !is_camera_matrix(m)) continue;
    Intrinsics k{0, 0, m[0], m[4], m[2], m[5], Distortion::none, {}};
    for (const auto& [other, coefficients] : matrices) {
      if (wanted(other) && contains(other, {"istortion"}) && coefficients.size() >= 4) {
        set_distortion("brown_conrady", coefficients, k);
      }
    }
    return k;
  }
  return std::nullopt;
}

/// Rotation and translation (millimetres, as OpenCV calibrations of depth cameras have them).
std::optional<Pose> stereo_pose(const std::map<std::string, std::vector<double>>& matrices) {
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
  if (fs::file_size(path, ignored) > kMaxBytes) return std::nullopt;
  const auto bytes = read_file_bytes(path, kMaxBytes);
  const auto matrices = matrices_in({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
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
