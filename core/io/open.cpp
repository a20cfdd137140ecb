#include <algorithm>
#include <fstream>
#include <map>

#include "core/io/bag/packed_file.hpp"
#include "core/io/bag/rosbag2_mcap.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/folder/folder_layout.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::io {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxDepth = 4;  // folders below the one given; a whole disk is no recording

std::vector<CloudFormat>& cloud_formats() {
  static std::vector<CloudFormat> formats;
  return formats;
}

bool is_of_added_format(const fs::path& path) {
  return std::ranges::find(cloud_formats(), extension(path), &CloudFormat::extension) !=
         cloud_formats().end();
}

/// Files of a kind in the folder, then those in the folders below it.
std::vector<fs::path> files_under(const fs::path& folder, bool (*is_wanted)(const fs::path&)) {
  std::vector<fs::path> wanted;
  for (const fs::path& file : files_in(folder)) {
    if (is_wanted(file)) wanted.push_back(file);
  }
  std::vector<fs::path> below;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it.depth() >= kMaxDepth) it.disable_recursion_pending();
    std::error_code ignored;
    if (it.depth() > 0 && is_wanted(it->path()) && it->is_regular_file(ignored)) {
      below.push_back(it->path());
    }
  }
  std::sort(below.begin(), below.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.string(), b.string());
  });
  wanted.insert(wanted.end(), below.begin(), below.end());
  return wanted;
}

}  // namespace

std::string extension(const fs::path& path) { return lower_case(path.extension().string()); }

bool is_ply(const fs::path& path) { return extension(path) == ".ply"; }
bool is_pcd(const fs::path& path) { return extension(path) == ".pcd"; }
bool is_bag(const fs::path& path) {
  const std::string kind = extension(name_within(path));
  return kind == ".bag" || kind == ".db3" || kind == ".mcap";
}
bool is_cloud(const fs::path& path) {
  return is_ply(path) || is_pcd(path) || is_of_added_format(path);
}

void add_cloud_format(const CloudFormat& format) { cloud_formats().push_back(format); }
const std::vector<CloudFormat>& added_cloud_formats() { return cloud_formats(); }

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t i0 = i, j0 = j;
    while (i < a.size() && digit(a[i])) ++i;
    while (j < b.size() && digit(b[j])) ++j;
    if (i - i0 != j - j0) return i - i0 < j - j0;
    const int order = a.compare(i0, i - i0, b, j0, j - j0);
    if (order != 0) return order < 0;
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // such as 01 and 1: any order, but always the same
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_regular_file(ignored) && !entry.path().filename().string().starts_with('.')) {
      files.push_back(entry.path());
    }
  }
  if (error) throw Error(folder.string() + ": cannot be listed: " + error.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

std::vector<fs::path> cloud_files_under(const fs::path& folder) {
  const auto clouds =
      files_under(folder, [](const fs::path& file) { return is_ply(file) || is_pcd(file); });
  return clouds.empty() ? files_under(folder, is_of_added_format) : clouds;
}

namespace {

std::string expected() {
  std::string kinds = ".ply or .pcd";
  for (const CloudFormat& format : added_cloud_formats()) kinds += " or " + format.extension;
  return "expected a .bag, .db3 or .mcap of RealSense or ROS, a folder with depth/ as 16-bit PNG, "
         "a RealSense Viewer .raw with its _metadata.csv, or a " +
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
  if (fs::exists(path / "metadata.yaml")) return open_bag(path, options);
  auto bags = files_in(path);
  std::erase_if(bags, [](const fs::path& file) { return !is_bag(file); });
  if (bags.size() == 1) return open_bag(bags.front(), options);
  if (bags.size() > 1) {
    throw Error(path.string() + ": a folder with " + std::to_string(bags.size()) +
                " recordings, expected the path of one of them, such as " + bags.front().string());
  }
  if (!cloud_files_under(path).empty()) return open_clouds(path, options);
  throw Error(path.string() + ": a folder with no recording in it (" +
              describe_files(files_in(path)) + "), " + expected());
}

std::string first_bytes(const fs::path& path) {
  std::ifstream file = open_to_read(path);
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
  if (is_bag(path) || start.starts_with("#ROSBAG") || start.starts_with("SQLite f") ||
      start == rosbag2::kMcapMagic) {
    return open_bag(path, options);
  }
  if (is_cloud(path)) return open_clouds(path, options);
  if (kind == ".raw" || kind == ".csv") return open_viewer_raw(path, options);
  if (start.starts_with("\x89PNG") || kind == ".png") return open_image_folder(path, options);
  throw Error(path.string() + ": not a recording that planescope reads, " + expected());
}

namespace {

class ChangedRecording : public Recording {
 public:
  ChangedRecording(std::shared_ptr<const Recording> recording, std::function<void(Frame&)> change)
      : recording_(std::move(recording)), change_(std::move(change)) {}

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return recording_->frame_count(); }
  Frame frame(int i) const override {
    Frame frame = recording_->frame(i);
    change_(frame);
    return frame;
  }
  double timestamp_s(int i) const override { return recording_->timestamp_s(i); }
  std::optional<Pose> T_world_camera(int i) const override { return recording_->T_world_camera(i); }
  std::string frame_hash(int i) const override { return recording_->frame_hash(i); }

 private:
  std::shared_ptr<const Recording> recording_;
  std::function<void(Frame&)> change_;
};

}  // namespace

std::shared_ptr<const Recording> with_changed_frames(std::shared_ptr<const Recording> recording,
                                                     std::function<void(Frame&)> change) {
  return std::make_shared<const ChangedRecording>(std::move(recording), std::move(change));
}

}  // namespace planescope::io
