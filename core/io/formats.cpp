// The table of recording formats. To add one: write a reader, add its row here and its opener in
// readers.hpp, and describe it in docs/formats.md.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "core/io/bag/message_log.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::io {

namespace fs = std::filesystem;

std::string extension(const fs::path& path) { return lower_case(path.extension().string()); }

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
  return a < b;  // such as 01 and 1: any order, as long as it is deterministic
}

std::vector<fs::path> entries_in(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (!entry.path().filename().string().starts_with('.')) entries.push_back(entry.path());
  if (error) throw Error(folder.string() + ": cannot be listed: " + error.message());
  std::sort(entries.begin(), entries.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return entries;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files = entries_in(folder);
  std::error_code ignored;
  std::erase_if(files, [&](const fs::path& path) { return !fs::is_regular_file(path, ignored); });
  return files;
}

namespace {

constexpr int kMaxDepth = 4;  // levels of subfolders: do not search a whole disk

/// Files of a kind in the folder, then those in its subfolders.
std::vector<fs::path> files_under(const fs::path& folder,
                                  const std::function<bool(const fs::path&)>& is_wanted) {
  std::error_code ignored;
  // Also dangling links and pipes: frames that are missing, not frames that never were.
  const auto is_file = [&](const fs::path& path) {
    return is_wanted(path) && !fs::is_directory(path, ignored);
  };
  std::vector<fs::path> wanted = entries_in(folder);
  std::erase_if(wanted, std::not_fn(is_file));
  std::vector<fs::path> below;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it.depth() >= kMaxDepth) it.disable_recursion_pending();
    if (it.depth() > 0 && is_file(it->path())) below.push_back(it->path());
  }
  std::sort(below.begin(), below.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.string(), b.string());
  });
  wanted.insert(wanted.end(), below.begin(), below.end());
  return wanted;
}

}  // namespace

std::vector<fs::path> cloud_files_under(const fs::path& folder) {
  const auto of_formats = [&](bool built_in) {
    return files_under(folder, [built_in](const fs::path& file) {
      const CloudFormat* format = cloud_format_of(file);
      return format && (format->check != nullptr) == built_in;
    });
  };
  const auto clouds = of_formats(true);
  return clouds.empty() ? of_formats(false) : clouds;
}

namespace {

/// The file or folder at a path.
struct Found {
  fs::path path;
  bool is_folder = false;
  std::string start;  // first bytes of a file
};

struct Format {
  std::string name;  // "a RealSense or ROS .bag, .db3, or .mcap"
  std::vector<std::string> extensions;
  bool (*sniff)(const Found&);  // folders, and files with other extensions
  std::unique_ptr<Recording> (*open)(const fs::path&, const RecordingOptions&);

  bool fits(const Found& found) const {
    if (found.is_folder) return sniff(found);
    return std::ranges::count(extensions, extension(found.path)) > 0 || sniff(found);
  }
};

/// A bag may be compressed as a whole.
bool is_bag(const fs::path& path) {
  const std::string kind = extension(name_within(path));
  return kind == ".bag" || kind == ".db3" || kind == ".mcap";
}

std::vector<fs::path> bags_in(const fs::path& folder) {
  auto bags = files_in(folder);
  std::erase_if(bags, std::not_fn(is_bag));
  return bags;
}

bool is_image_folder(const fs::path& folder) {
  return viewer_raw_files(folder).empty() && !find_folder_layout(folder).depth.empty();
}

bool sniff_bag(const Found& found) {
  if (found.is_folder)
    return (fs::exists(found.path / "metadata.yaml") || !bags_in(found.path).empty()) &&
           viewer_raw_files(found.path).empty() && !is_image_folder(found.path);
  return is_bag(found.path) || found.start.starts_with("#ROSBAG") ||
         found.start.starts_with("SQLite f") || found.start == kMcapMagic;
}

std::unique_ptr<Recording> open_bag_at(const fs::path& path, const RecordingOptions& options) {
  if (!fs::is_directory(path) || fs::exists(path / "metadata.yaml")) return open_bag(path, options);
  const auto bags = bags_in(path);
  if (bags.size() > 1)
    throw Error(path.string() + ": a folder with " + std::to_string(bags.size()) +
                " recordings; expected the path to one recording, such as " +
                bags.front().string());
  return open_bag(bags.front(), options);
}

std::vector<Format> formats() {
  std::vector<std::string> clouds;
  for (const CloudFormat& format : cloud_formats()) clouds.push_back(format.extension);
  return {
      {"a RealSense or ROS .bag, .db3, or .mcap",
       {".bag", ".db3", ".mcap"},
       sniff_bag,
       open_bag_at},
      {"a folder of 16-bit depth PNGs",
       {".png"},
       [](const Found& found) {
         return found.is_folder
                    ? is_image_folder(found.path)
                    : found.start.starts_with("\x89PNG") ||
                          (is_depth_dump(found.path) && viewer_raw_files(found.path).empty());
       },
       open_image_folder},
      {"a RealSense Viewer .raw with its _metadata.csv",
       {".raw", ".csv"},
       [](const Found& found) { return found.is_folder && !viewer_raw_files(found.path).empty(); },
       open_viewer_raw},
      {fmt::format("a {}, or {} cloud", fmt::join(clouds.begin(), clouds.end() - 1, ", "),
                   clouds.back()),
       clouds,
       [](const Found& found) { return found.is_folder && !cloud_files_under(found.path).empty(); },
       open_clouds}};
}

std::string format_names(bool clouds = true) {
  std::vector<std::string> names;
  for (const Format& format : formats())
    if (clouds || format.open != open_clouds) names.push_back(format.name);
  return fmt::format("{}, or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

/// Summary of the files in a folder for messages: "3 .txt, 1 .jpg".
std::string describe_files(const std::vector<fs::path>& files) {
  std::map<std::string, int> kinds;
  for (const fs::path& file : files) {
    const std::string kind = extension(file);
    ++kinds[kind.empty() ? "without an extension" : kind];
  }
  std::string text;
  for (const auto& [kind, count] : kinds) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  return text.empty() ? "no files" : text;
}

std::string first_bytes(const fs::path& path) {
  std::ifstream file = open_to_read(path);
  std::string bytes(8, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

std::string recordings_text(bool many, bool clouds) {
  return (many ? "Recordings, each " : "Recording: ") + format_names(clouds);
}

namespace {

class ChangedRecording : public Recording {
 public:
  ChangedRecording(std::shared_ptr<const Recording> recording, std::function<void(Frame&)> change)
      : recording_(std::move(recording)), info_(recording_->info()), change_(std::move(change)) {}
  ChangedRecording(std::shared_ptr<const Recording> recording,
                   const std::vector<std::string>& more_warnings)
      : ChangedRecording(std::move(recording), [](Frame&) {}) {
    info_.warnings.insert(info_.warnings.end(), more_warnings.begin(), more_warnings.end());
  }

  const RecordingInfo& info() const override { return info_; }
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
  RecordingInfo info_;
  std::function<void(Frame&)> change_;
};

/// Adds warnings about an implausible camera, color or depth unit.
std::unique_ptr<Recording> checked(std::unique_ptr<Recording> recording, bool of_color) {
  const RecordingInfo& info = recording->info();
  std::vector<std::string> warnings = camera_warnings(info, of_color);
  if (info.width > 0 && recording->frame_count() > 0) {
    try {
      for (std::string& warning : frame_warnings(info, recording->frame(0)))
        warnings.push_back(std::move(warning));
    } catch (const Error&) {
      // Damaged: reported when the frame is read.
    }
  }
  if (warnings.empty()) return recording;
  return std::make_unique<ChangedRecording>(std::move(recording), warnings);
}

}  // namespace

std::unique_ptr<Recording> open_recording(const fs::path& path, const RecordingOptions& options) {
  if (path == "-") {
    if (!options.standard_input)
      throw Error(
          "-: only segment, convert, and info read standard input; to save it as a recording, use "
          "planescope convert - -o FOLDER");
    std::unique_ptr<FrameStream> stream = open_stream(0, options, true);
    while (stream->wait_for_frame({})) continue;
    if (stream->frame_count() == 0) throw Error("standard input: no frames after the header");
    return stream;
  }
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) throw Error(path.string() + ": no such file or folder");
  Found found{path, fs::is_directory(status), {}};
  if (!found.is_folder) found.start = first_bytes(path);
  const std::vector<Format> known = formats();
  for (const Format& format : known) {
    if (!format.fits(found)) continue;
    if (!options.topic.empty() && format.open != open_bag_at)
      throw Error(fmt::format("{}: {}, which has no topics; --topic requires {}", path.string(),
                              format.name, known.front().name));
    return naming_memory(path.string(),
                         [&] { return checked(format.open(path, options), options.color); });
  }
  if (found.is_folder)
    throw Error(path.string() + ": the folder contains no recording (" +
                describe_files(files_in(path)) + "); expected " + format_names());
  if (found.start == "version ") read_file_bytes(path, 1000);  // throws if it is a Git LFS pointer
  throw Error(path.string() + ": not a supported recording; expected " + format_names());
}

std::vector<std::optional<int>> find_frames(const Recording& recording,
                                            std::span<const FrameIdentity> wanted) {
  const auto hash_of = [&](int i) {
    try {
      return recording.frame_hash(i);
    } catch (const Error&) {  // damaged: reported when the frame is used
      return std::string();
    }
  };
  const auto is_in_place = [&](const FrameIdentity& frame) {
    if (frame.index < 0 || frame.index >= recording.frame_count()) return false;
    const std::string hash = hash_of(frame.index);
    return hash.empty() || hash == frame.sha256;
  };
  std::vector<std::optional<int>> found;
  if (std::ranges::all_of(wanted, is_in_place)) {
    for (const FrameIdentity& frame : wanted) found.emplace_back(frame.index);
    return found;
  }
  // With the number as a name: of frames with equal pixels, the one in its place comes first.
  std::vector<FrameIdentity> all, named;
  for (int i = 0; i < recording.frame_count(); ++i)
    all.push_back({i, hash_of(i), std::to_string(i), 0});
  std::map<std::pair<int, std::string>, std::size_t> unique;
  for (const FrameIdentity& frame : wanted)
    if (unique.emplace(std::pair(frame.index, frame.sha256), named.size()).second)
      named.push_back({frame.index, frame.sha256, std::to_string(frame.index), 0});
  const std::vector<int> partners = match_frames(all, named);
  for (const FrameIdentity& frame : wanted) {
    const int at = partners[unique[std::pair(frame.index, frame.sha256)]];
    const bool is_same = at >= 0 && all[static_cast<std::size_t>(at)].sha256 == frame.sha256;
    found.push_back(is_same ? std::optional(at) : std::nullopt);
  }
  return found;
}

std::shared_ptr<const Recording> with_changed_frames(std::shared_ptr<const Recording> recording,
                                                     std::function<void(Frame&)> change) {
  return std::make_shared<const ChangedRecording>(std::move(recording), std::move(change));
}

}  // namespace planescope::io
