#include "core/io/folder/folder_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/folder/frame_times.hpp"
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

/// Takes `word` out of `text`, with one separator beside it; false where it is not in there.
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

/// What a depth image and its colour image have in common: the name without the word for each.
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

/// Same name first, then nearest time, then the same place in the order.
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
                              " depth images have no colour image of their name or time");
  }
}

/// Pairs depth with color, and finds when it was taken.
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
    if (!sources.empty()) break;  // else times of the color images will do
  }
  layout.times_source = fmt::format("{}", fmt::join(sources, ", "));
  const auto missing = std::ranges::count_if(layout.time_s, [](const auto& time) { return !time; });
  if (missing > 0 && !sources.empty())
    layout.warnings.push_back(fmt::format("{} of {} depth images have no time in {}", missing,
                                          layout.time_s.size(), layout.times_source));
}

/// The subfolder of one of these names, whatever its case; empty where there is none.
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

bool named_color(const fs::path& path) {
  const std::string name = lower_case(path.stem().string());
  return is_picture(path) && !named_depth(path) &&
         std::any_of(std::begin(kColorWords), std::end(kColorWords),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

bool is_depth_by_content(const fs::path& path) {
  if (!is_png(path)) return false;
  try {
    const PngInfo info = png_info(path);
    return info.channels == 1 && info.bit_depth == 16;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

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
  const std::vector<fs::path> here = files_in(folder);
  const fs::path depth_folder = subfolder(folder, {"depth"});
  if (!depth_folder.empty()) {
    layout.depth = only(files_in(depth_folder), is_png);
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
  layout.depth = only(here, named_depth);
  if (layout.depth.empty()) {
    layout.depth = only(here, is_depth_by_content);
    settle(folder, {}, layout);
    return layout;
  }
  settle(folder, only(here, named_color), layout);
  return layout;
}

}  // namespace planescope::io
