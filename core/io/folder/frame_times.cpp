#include "core/io/folder/frame_times.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/model/text_lines.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;

/// Which image a list means by a name: one of the path, else the only one of the file name.
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

  /// Null: none; `ambiguous` is set where several have this name.
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
  std::optional<Error> damage;                       // counts where the file turns out to be a list
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
                  fmt::format("{} was listed with another time in line {}",
                              one_line(line.words[2 * column + 1]), at->second.second));
      }
    } catch (const Error& error) {
      if (!damage) damage = error;
    }
  }
  if (ambiguous)
    listed.warnings.push_back(list.string() +
                              ": ignored, as depth and color images have the same names; expected "
                              "names with their folders");
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
    read_list(list, 1, "a time and a depth image", {&depth}, listed);
  if (const fs::path list = file_beside_images(folder, "rgb.txt"); !list.empty())
    read_list(list, 1, "a time and a color image", {&color}, listed);
  if (const fs::path list = file_beside_images(folder, "associations.txt"); !list.empty())
    read_list(list, 2, "a time and an image, twice", {&depth, &color}, listed);
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
  warnings.push_back(fmt::format("{}: {} for {}: expected as many, to take their times",
                                 file.string(), counted(times.size(), "pose"),
                                 counted(frames, "frame")));
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
  // As published, samples at rest point where things fall, not along the reaction.
  std::optional<Gravity> gravity = gravity_of_accelerometer(
      -sum / static_cast<double>(samples.size()), samples.size(), kReach_s);
  if (gravity) gravity->note += std::string(", ") + kFile;
  return gravity;
}

}  // namespace planescope::io
