#include <algorithm>
#include <fstream>
#include <map>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/folder/folder_layout.hpp"
#include "core/io/folder/raw_files.hpp"
#include "core/io/readers.hpp"
#include "core/io/sniff.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

std::string expected() {
  std::string kinds = ".ply or .pcd";
  for (const CloudFormat& format : added_cloud_formats()) kinds += " or " + format.extension;
  return "expected a RealSense .bag, a folder with depth/ as 16-bit PNG, a RealSense Viewer .raw "
         "with its _metadata.csv, or a " +
         kinds + " cloud";
}

/// What lies in a folder, for people: "3 .txt, 1 .jpg".
std::string describe_files(const std::vector<fs::path>& files) {
  std::map<std::string, int> kinds;
  for (const fs::path& file : files) {
    const std::string kind = extension(file);
    ++kinds[kind.empty() ? "without extension" : kind];
  }
  std::string text;
  for (const auto& [kind, count] : kinds) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  return text.empty() ? "no files" : text;
}

std::unique_ptr<Recording> open_folder(const fs::path& path, const RecordingOptions& options) {
  if (!viewer_raw_files(path).empty()) return open_viewer_raw(path, options);
  if (!find_folder_layout(path).depth.empty()) return open_image_folder(path, options);
  const auto files = files_in(path);
  std::vector<fs::path> bags;
  std::copy_if(files.begin(), files.end(), std::back_inserter(bags),
               [](const fs::path& file) { return extension(file) == ".bag"; });
  if (bags.size() == 1) return open_bag(bags.front(), options);
  if (bags.size() > 1) {
    throw Error(path.string() + ": a folder with " + std::to_string(bags.size()) +
                " bags, expected the path of one of them, such as " + bags.front().string());
  }
  if (!cloud_files_under(path).empty()) return open_clouds(path, options);
  throw Error(path.string() + ": a folder with no recording in it (" + describe_files(files) +
              "), " + expected());
}

std::string first_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be opened for reading");
  std::string bytes(8, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

std::unique_ptr<Recording> open_recording(const fs::path& path, const RecordingOptions& options) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) throw Error(path.string() + ": no such file or folder");
  if (fs::is_directory(status)) return open_folder(path, options);
  const std::string start = first_bytes(path);
  const std::string kind = extension(path);
  if (kind == ".bag" || start.starts_with("#ROSBAG")) return open_bag(path, options);
  if (is_cloud(path)) return open_clouds(path, options);
  if (kind == ".raw" || kind == ".csv") return open_viewer_raw(path, options);
  if (start.starts_with("\x89PNG") || kind == ".png") return open_image_folder(path, options);
  throw Error(path.string() + ": not a recording that planescope reads, " + expected());
}

}  // namespace planescope::io
