#include "core/labels/model/label_files.hpp"

#include <algorithm>
#include <cstdio>

#include "core/io/image/png.hpp"
#include "core/labels/model/label_file_bytes.hpp"
#include "core/labels/model/label_json.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxJsonBytes = 64u << 20;  // 65534 planes need about 15 MB

}  // namespace

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

fs::path default_label_dir(const fs::path& recording) {
  fs::path path = recording.lexically_normal();
  if (path == "." || path.filename() == "..") path = fs::absolute(path).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  path += ".labels";
  return path;
}

std::array<fs::path, kLabelFiles> label_file_paths(const fs::path& dir, int frame_index) {
  char stem[16];
  std::snprintf(stem, sizeof(stem), "%06d", frame_index);
  return {dir / (stem + std::string(".plane.png")), dir / (stem + std::string(".hv.png")),
          dir / (stem + std::string(".json"))};
}

LabelFileBytes encode_label_files(const fs::path& dir, int frame_index, const FrameLabels& labels) {
  check_labels(labels, label_file_paths(dir, frame_index).back().string());
  const std::string json = label_json(frame_index, labels);
  return {io::encode_png(labels.plane), io::encode_png(labels.hv), {json.begin(), json.end()}};
}

void write_label_files(const fs::path& dir, int frame_index, const LabelFileBytes& bytes) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": cannot be made a folder: " + error.message());
  const auto paths = label_file_paths(dir, frame_index);
  for (std::size_t i = 0; i < kLabelFiles; ++i) write_file_bytes(paths[i], bytes[i], Durable::yes);
}

void write_frame_labels(const fs::path& dir, int frame_index, const FrameLabels& labels) {
  write_label_files(dir, frame_index, encode_label_files(dir, frame_index, labels));
}

std::optional<FrameLabels> read_frame_labels(const fs::path& dir,
                                             int frame_index,
                                             const std::string& expected_sha256) {
  const auto paths = label_file_paths(dir, frame_index);
  if (std::none_of(paths.begin(), paths.end(), is_there)) return std::nullopt;

  const auto& [plane_path, hv_path, json_path] = paths;
  const auto bytes = read_file_bytes(json_path, kMaxJsonBytes);
  FrameLabels labels =
      parse_label_json(std::string(bytes.begin(), bytes.end()), frame_index, json_path.string());
  if (!expected_sha256.empty() && labels.depth_sha256 != expected_sha256) {
    throw Error(json_path.string() + ": made for a depth image with SHA-256 " +
                labels.depth_sha256.substr(0, 12) + ", this recording's frame has " +
                expected_sha256.substr(0, 12));
  }
  // The headers first: images that would be refused for their size are not decoded.
  for (const fs::path& path : {plane_path, hv_path}) {
    const io::PngInfo info = io::png_info(path);
    if (info.width != labels.intrinsics.width || info.height != labels.intrinsics.height) {
      throw Error(path.string() + ": " + std::to_string(info.width) + "x" +
                  std::to_string(info.height) + " pixels, its frame has " +
                  std::to_string(labels.intrinsics.width) + "x" +
                  std::to_string(labels.intrinsics.height));
    }
  }
  labels.plane = io::read_png_16(plane_path);
  labels.hv = io::read_png_grey(hv_path);
  check_labels(labels, json_path.string());
  return labels;
}

}  // namespace planescope::labels
