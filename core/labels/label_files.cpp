#include "core/labels/label_files.hpp"

#include <cstdio>
#include <span>

#include "core/base/error.hpp"
#include "core/base/file_bytes.hpp"
#include "core/image/png.hpp"
#include "core/labels/label_json.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxJsonBytes = 64u << 20;  // 65534 planes need about 15 MB

struct LabelPaths {
  fs::path plane, hv, json;
};

LabelPaths label_paths(const fs::path& dir, int frame_index) {
  char stem[16];
  std::snprintf(stem, sizeof(stem), "%06d", frame_index);
  return {dir / (stem + std::string(".plane.png")), dir / (stem + std::string(".hv.png")),
          dir / (stem + std::string(".json"))};
}

/// Writes beside the target and renames: whoever reads meanwhile, or after a crash, finds a whole
/// file.
void replace_file(const fs::path& path, std::span<const unsigned char> bytes) {
  fs::path temporary = path;
  temporary += ".tmp";
  std::error_code error;
  try {
    write_file_bytes(temporary, bytes);
  } catch (const Error&) {
    fs::remove(temporary, error);
    throw;
  }
  fs::rename(temporary, path, error);
  if (error) {
    const std::string reason = error.message();
    fs::remove(temporary, error);
    throw Error(path.string() + ": cannot be replaced: " + reason);
  }
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

}  // namespace

fs::path default_label_dir(const fs::path& recording) {
  fs::path path = recording.lexically_normal();
  if (path == "." || path.filename() == "..") path = fs::absolute(path).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  path += ".labels";
  return path;
}

void write_frame_labels(const fs::path& dir, int frame_index, const FrameLabels& labels) {
  const LabelPaths paths = label_paths(dir, frame_index);
  check_labels(labels, paths.json.string());
  const auto plane = encode_png(labels.plane);
  const auto hv = encode_png(labels.hv);
  const std::string json = label_json(frame_index, labels);

  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": cannot be made a folder: " + error.message());
  replace_file(paths.plane, plane);
  replace_file(paths.hv, hv);
  replace_file(paths.json,
               std::span(reinterpret_cast<const unsigned char*>(json.data()), json.size()));
}

std::optional<FrameLabels> read_frame_labels(const fs::path& dir,
                                             int frame_index,
                                             const std::string& expected_sha256) {
  const LabelPaths paths = label_paths(dir, frame_index);
  if (!is_there(paths.json) && !is_there(paths.plane) && !is_there(paths.hv)) return std::nullopt;

  const auto bytes = read_file_bytes(paths.json, kMaxJsonBytes);
  FrameLabels labels =
      parse_label_json(std::string(bytes.begin(), bytes.end()), frame_index, paths.json.string());
  if (!expected_sha256.empty() && labels.depth_sha256 != expected_sha256) {
    throw Error(paths.json.string() + ": made for a depth image with SHA-256 " +
                labels.depth_sha256.substr(0, 12) + ", this recording's frame has " +
                expected_sha256.substr(0, 12));
  }
  // The headers first: images that would be refused for their size are not decoded.
  for (const fs::path& path : {paths.plane, paths.hv}) {
    const PngInfo info = png_info(path);
    if (info.width != labels.intrinsics.width || info.height != labels.intrinsics.height) {
      throw Error(path.string() + ": " + std::to_string(info.width) + "x" +
                  std::to_string(info.height) + " pixels, its frame has " +
                  std::to_string(labels.intrinsics.width) + "x" +
                  std::to_string(labels.intrinsics.height));
    }
  }
  labels.plane = read_png_16(paths.plane);
  labels.hv = read_png_grey(paths.hv);
  check_labels(labels, paths.json.string());
  return labels;
}

}  // namespace planescope
