// Finds the depth images of a folder, their color images, timestamps and accelerometer samples.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "core/io/folder/folder_files.hpp"
#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxColorGap_s = 0.5;
constexpr const char* kColorWords[] = {"color", "colour", "rgb", "image"};

bool is_png(const fs::path& path) { return extension(path) == ".png"; }
bool is_picture(const fs::path& path) {
  return is_png(path) || extension(path) == ".jpg" || extension(path) == ".jpeg";
}

/// Removes `word` and one adjacent separator from `text`. False if `text` does not contain it.
bool remove_word(std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  if (at == std::string::npos) return false;
  text.erase(at, word.size());
  const auto is_separator = [&](std::size_t i) {
    return i < text.size() && (text[i] == '_' || text[i] == '-' || text[i] == '.');
  };
  if (is_separator(at)) {
    text.erase(at, 1);
  } else if (at > 0 && is_separator(at - 1)) {
    text.erase(at - 1, 1);
  }
  return true;
}

/// The common part of the names of a depth image and its color image: without the word for each.
std::string pairing_key(const fs::path& path) {
  std::string key = lower_case(path.stem().string());
  if (remove_word(key, "depth")) return key;
  for (const char* word : kColorWords) {
    if (remove_word(key, word)) return key;
  }
  return key;
}

using TimeOf = std::function<std::optional<double>(const fs::path&)>;

void pair_by_time(const std::vector<fs::path>& color, const TimeOf& time_of, FolderLayout& layout) {
  std::map<double, fs::path> by_time;
  for (const fs::path& path : color) by_time.emplace(*time_of(path), path);
  for (std::size_t i = 0; i < layout.depth.size(); ++i) {
    const double time_s = *time_of(layout.depth[i]);
    auto best = by_time.lower_bound(time_s);
    if (best == by_time.end() ||
        (best != by_time.begin() && time_s - std::prev(best)->first < best->first - time_s)) {
      --best;
    }
    if (std::abs(best->first - time_s) <= kMaxColorGap_s) layout.color[i] = best->second;
  }
}

/// Match by name, then by nearest time, then by index.
void pair_color(const std::vector<fs::path>& color, const TimeOf& time_of, FolderLayout& layout) {
  if (color.empty()) return;
  std::map<std::string, fs::path> by_key;
  for (const fs::path& path : color) by_key.emplace(pairing_key(path), path);
  for (std::size_t i = 0; i < layout.depth.size(); ++i) {
    const auto found = by_key.find(pairing_key(layout.depth[i]));
    if (found != by_key.end()) layout.color[i] = found->second;
  }
  const auto has_time = [&](const fs::path& path) { return time_of(path).has_value(); };
  if (!layout.has_color()) {
    if (std::all_of(layout.depth.begin(), layout.depth.end(), has_time) &&
        std::all_of(color.begin(), color.end(), has_time)) {
      pair_by_time(color, time_of, layout);
    } else if (color.size() == layout.depth.size()) {
      layout.color = color;
    }
  }
  const auto without = std::count(layout.color.begin(), layout.color.end(), fs::path{});
  if (without > 0) {
    layout.warnings.push_back(std::to_string(without) + " of " +
                              std::to_string(layout.depth.size()) +
                              " depth images have no color image with the same name or time");
  }
}

/// Pairs depth with color images, and finds the times.
void settle(const fs::path& folder, const std::vector<fs::path>& color, FolderLayout& layout) {
  ListedTimes listed = listed_times(folder, layout.depth, color);
  layout.warnings = std::move(listed.warnings);
  const TimeOf time_of = [&](const fs::path& image) {
    const auto at = listed.of_image.find(image);
    return at != listed.of_image.end() ? at->second.s : timestamp_in_name(image);
  };
  layout.color.assign(layout.depth.size(), {});
  pair_color(color, time_of, layout);
  layout.time_s.assign(layout.depth.size(), std::nullopt);
  std::set<std::string> sources;
  for (const std::vector<fs::path>* images : {&layout.depth, &layout.color}) {
    for (std::size_t i = 0; i < images->size(); ++i) {
      const fs::path& image = (*images)[i];
      layout.time_s[i] = image.empty() ? std::nullopt : time_of(image);
      if (!layout.time_s[i]) continue;
      const auto at = listed.of_image.find(image);
      sources.insert(at != listed.of_image.end() ? at->second.list : "file names");
    }
    if (!sources.empty()) break;  // else use the times of the color images
  }
  layout.times_source = fmt::format("{}", fmt::join(sources, ", "));
  const auto missing = std::ranges::count_if(layout.time_s, [](const auto& time) { return !time; });
  if (missing > 0 && !sources.empty())
    layout.warnings.push_back(fmt::format("{} of {} depth images have no time in {}", missing,
                                          layout.time_s.size(), layout.times_source));
}

/// The subfolder with one of these names, ignoring case; empty if there is none.
fs::path subfolder(const fs::path& folder, std::initializer_list<const char*> names) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_directory(ignored)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  for (const char* name : names) {
    for (const fs::path& path : found) {
      if (lower_case(path.filename().string()) == name) return path;
    }
  }
  return {};
}

std::vector<fs::path> only(const std::vector<fs::path>& files, bool (*wanted)(const fs::path&)) {
  std::vector<fs::path> kept;
  std::copy_if(files.begin(), files.end(), std::back_inserter(kept), wanted);
  return kept;
}

bool named_depth(const fs::path& path) {
  return is_png(path) && lower_case(path.stem().string()).find("depth") != std::string::npos;
}

/// Dumps if there are any, since the PNGs beside dumps are pictures of depth.
std::vector<fs::path> depth_among(const std::vector<fs::path>& files,
                                  bool (*png)(const fs::path&)) {
  const std::vector<fs::path> dumps = only(files, is_depth_dump);
  return dumps.empty() ? only(files, png) : dumps;
}

bool named_color(const fs::path& path) {
  const std::string name = lower_case(path.stem().string());
  return is_picture(path) && !named_depth(path) &&
         std::any_of(std::begin(kColorWords), std::end(kColorWords),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

/// The 16-bit grey PNGs and, if there are any, PNGs that cannot be read: damaged frames.
std::vector<fs::path> depth_by_content(const std::vector<fs::path>& entries) {
  std::vector<fs::path> depth;
  bool any_readable = false;
  for (const fs::path& path : only(entries, is_png)) {
    try {
      expect_regular_file(path);
      const PngInfo info = png_info(path);
      if (info.channels != 1 || info.bit_depth != 16) continue;
      any_readable = true;
    } catch (const Error&) {
    }
    depth.push_back(path);
  }
  return any_readable ? depth : std::vector<fs::path>();
}

}  // namespace

bool is_depth_dump(const fs::path& path) {
  return extension(path) == ".raw" &&
         lower_case(path.stem().string()).find("_depth_") != std::string::npos;
}

bool FolderLayout::has_color() const {
  return std::any_of(color.begin(), color.end(), [](const fs::path& p) { return !p.empty(); });
}

std::optional<double> timestamp_in_name(const fs::path& path) {
  const std::string name = path.stem().string();
  const std::size_t before = name.find_last_not_of("0123456789.");
  const std::string number = before == std::string::npos ? name : name.substr(before + 1);
  const std::size_t whole_digits = std::min(number.find('.'), number.size());
  const auto value = parse_number(number);
  // 0000000012 is a number with leading zeros.
  if (!value || whole_digits < 10 || number[0] == '0') return std::nullopt;
  if (*value >= 1e17) return *value * 1e-9;
  if (*value >= 1e14) return *value * 1e-6;
  if (*value >= 1e11) return *value * 1e-3;
  return *value;
}

FolderLayout find_folder_layout(const fs::path& folder) {
  FolderLayout layout;
  // Entries that are not files are damaged frames: without them, later frames would be renumbered.
  const std::vector<fs::path> here = entries_in(folder);
  const fs::path depth_folder = subfolder(folder, {"depth"});
  if (!depth_folder.empty()) {
    layout.depth = depth_among(entries_in(depth_folder), is_png);
    const fs::path color_folder = subfolder(folder, {"color", "rgb", "colour", "image", "images"});
    std::vector<fs::path> color;
    if (!color_folder.empty()) color = only(files_in(color_folder), is_picture);
    const auto has = [&](const char* name) {
      return std::find(here.begin(), here.end(), folder / name) != here.end();
    };
    layout.tum = has("depth.txt") && has("rgb.txt");
    if (!layout.depth.empty()) {
      settle(folder, color, layout);
      return layout;
    }
  }
  layout.depth = depth_among(here, named_depth);
  if (layout.depth.empty()) {
    layout.depth = depth_by_content(here);
    settle(folder, {}, layout);
    return layout;
  }
  settle(folder, only(files_in(folder), named_color), layout);
  return layout;
}

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;

/// Resolves image names in a list: by path, else by file name if only one image has it.
class ImagesByName {
 public:
  ImagesByName(const fs::path& list, std::initializer_list<const std::vector<fs::path>*> images)
      : folder_(list.parent_path()) {
    for (const std::vector<fs::path>* some : images)
      for (const fs::path& image : *some) {
        by_path_.emplace(image.lexically_normal(), &image);
        const auto [at, is_new] = by_file_.emplace(image.filename(), &image);
        if (!is_new) at->second = nullptr;
      }
  }

  /// Null if there is none. Sets `ambiguous` if several images have this name.
  const fs::path* find(const std::string& name, bool& ambiguous) const {
    if (const auto at = by_path_.find((folder_ / name).lexically_normal()); at != by_path_.end())
      return at->second;
    const auto at = by_file_.find(fs::path(name).filename());
    if (at == by_file_.end()) return nullptr;
    ambiguous |= at->second == nullptr;
    return at->second;
  }

 private:
  fs::path folder_;
  std::map<fs::path, const fs::path*> by_path_, by_file_;
};

/// Adds the times of a list with `columns` pairs of time and image per line.
void read_list(const fs::path& list,
               std::size_t columns,
               const char* expected,
               std::initializer_list<const std::vector<fs::path>*> images,
               ListedTimes& listed) {
  const ImagesByName by_name(list, images);
  std::map<fs::path, std::pair<double, int>> found;  // time and line
  std::optional<Error> damage;                       // thrown only if this is a list
  bool ambiguous = false;
  for (const TextLine& line : read_text_lines(list, kMostBytes)) {
    if (line.words.empty()) continue;
    try {
      if (line.words.size() != 2 * columns)
        fail_at(list, line,
                fmt::format("{}; expected {}", counted(line.words.size(), "word"), expected));
      for (std::size_t column = 0; column < columns; ++column) {
        const fs::path* image = by_name.find(line.words[2 * column + 1], ambiguous);
        const double time_s = number_in(list, line, 2 * column, expected);
        if (!image) continue;
        const auto [at, is_new] = found.emplace(*image, std::pair(time_s, line.number));
        if (!is_new && at->second.first != time_s)
          fail_at(list, line,
                  fmt::format("{} is listed with a different time in line {}",
                              one_line(line.words[2 * column + 1]), at->second.second));
      }
    } catch (const Error& error) {
      if (!damage) damage = error;
    }
  }
  if (ambiguous)
    listed.warnings.push_back(list.string() +
                              ": ignored, because depth and color images have the same names; "
                              "expected names that include the folder");
  if (found.empty() || ambiguous) return;
  if (damage) throw Error(*damage);
  for (const auto& [image, time] : found)
    listed.of_image.emplace(image, ListedTimes::Time{time.first, list.filename().string()});
}

}  // namespace

fs::path file_beside_images(const fs::path& folder, const char* name) {
  std::error_code ignored;
  if (folder.empty()) return {};
  if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  const fs::path whole = fs::absolute(folder / "", ignored).lexically_normal().parent_path();
  if (lower_case(whole.filename().string()) != "depth") return {};
  const fs::path beside = whole.parent_path() / name;
  return fs::is_regular_file(beside, ignored) ? beside : fs::path();
}

ListedTimes listed_times(const fs::path& folder,
                         const std::vector<fs::path>& depth,
                         const std::vector<fs::path>& color) {
  ListedTimes listed;
  if (const fs::path list = file_beside_images(folder, "depth.txt"); !list.empty())
    read_list(list, 1, "a time and the name of a depth image", {&depth}, listed);
  if (const fs::path list = file_beside_images(folder, "rgb.txt"); !list.empty())
    read_list(list, 1, "a time and the name of a color image", {&color}, listed);
  if (const fs::path list = file_beside_images(folder, "associations.txt"); !list.empty())
    read_list(list, 2, "two pairs of a time and an image name", {&depth, &color}, listed);
  return listed;
}

std::vector<double> times_of_poses(const fs::path& folder,
                                   std::size_t frames,
                                   std::vector<std::string>& warnings) {
  const fs::path file = file_beside_images(folder, "poses.tum");
  if (file.empty()) return {};
  std::vector<double> times;
  for (const TextLine& line : read_text_lines(file, kMostBytes))
    if (!line.words.empty())
      times.push_back(
          numbers_in(file, line, 8, "the eight numbers timestamp tx ty tz qx qy qz qw")[0]);
  if (std::ranges::all_of(times, [](double time_s) { return time_s == 0; })) return {};
  if (times.size() == frames) return times;
  warnings.push_back(
      fmt::format("{}: {} for {}, so its times are ignored; expected one pose per frame",
                  file.string(), counted(times.size(), "pose"), counted(frames, "frame")));
  return {};
}

Accelerometer::Accelerometer(const fs::path& folder) {
  const fs::path file = file_beside_images(folder, kFile);
  if (file.empty()) return;
  for (const TextLine& line : read_text_lines(file, kMostBytes)) {
    if (line.words.empty()) continue;
    const std::vector<double> n = numbers_in(file, line, 4, "the four numbers timestamp ax ay az");
    // The Kinect's accelerometer: x right, y down, z backward.
    samples_.push_back({n[0], Vec3d(n[1], n[2], -n[3])});
  }
  std::ranges::stable_sort(samples_, {}, &Sample::time_s);
}

std::span<const Accelerometer::Sample> Accelerometer::about(double time_s) const {
  const auto first = std::ranges::lower_bound(samples_, time_s - kReach_s, {}, &Sample::time_s);
  const auto end = std::ranges::upper_bound(samples_, time_s + kReach_s, {}, &Sample::time_s);
  return first < end ? std::span(first, end) : std::span<const Sample>();
}

std::optional<Gravity> Accelerometer::gravity_at(double time_s) const {
  const std::span<const Sample> samples = about(time_s);
  if (samples.empty()) return std::nullopt;
  Vec3d sum = Vec3d::Zero();
  for (const Sample& sample : samples) sum += sample.m_s2;
  // In published files, samples at rest point along gravity, not along the reaction to it.
  std::optional<Gravity> gravity = gravity_of_accelerometer(
      -sum / static_cast<double>(samples.size()), samples.size(), kReach_s);
  if (gravity) gravity->note += std::string(", ") + kFile;
  return gravity;
}

}  // namespace planescope::io
