// Reads trajectories (TUM, KITTI, Open3D) and matches their poses with frames.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <span>
#include <unordered_map>

#include "core/model/error.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::world {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;
constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
constexpr double kUnit = 1e-3;  // tolerance for rotations (matrix or quaternion)
constexpr int kMostSegments = 100'000;

constexpr const char* kTumLine = "the eight numbers of a TUM pose, timestamp tx ty tz qx qy qz qw";
constexpr const char* kKittiLine = "the twelve numbers of a KITTI pose, a 3x4 matrix";
constexpr const char* kLogHead = "the three integers at the start of a pose in an Open3D .log file";
constexpr const char* kLogRow = "the four numbers of a matrix row";

bool all_have_frames(const std::vector<CameraPose>& poses) {
  return std::ranges::all_of(poses, [](const CameraPose& pose) { return pose.frame >= 0; });
}

/// Poses of a file with their positions in it.
struct PosesOfFile {
  std::vector<CameraPose> poses;
  const char* unit = "line";
  std::vector<int> at;

  void add(const CameraPose& pose, int where) {
    poses.push_back(pose);
    at.push_back(where);
  }
};

/// Row-major 3x4 or 4x4. nullopt if it is not a rigid motion.
std::optional<Pose> pose_of_matrix(std::span<const double> m) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = m[row * 4 + column];
  const Mat3d r = pose.linear();
  if (!((r * r.transpose() - Mat3d::Identity()).norm() < 10 * kUnit) || r.determinant() < 0)
    return std::nullopt;
  if (m.size() == 16 && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)) return std::nullopt;
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  return pose;
}

/// "frame 12 segment 0 fitness 0.93 rms_m 0.0031": applies to the following pose.
void read_comment(const std::string& text, CameraPose& pose) {
  const std::vector<std::string> words = words_of(text);
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const std::optional<double> value = parse_number(words[i + 1]);
    if (!value) return;
    const bool is_whole = std::abs(*value) < 1e9 && *value == std::floor(*value) && *value >= 0;
    if (words[i] == "frame" && is_whole) pose.frame = static_cast<int>(*value);
    if (words[i] == "segment" && is_whole) pose.segment = static_cast<int>(*value);
    if (words[i] == "fitness") pose.fitness = *value;
    if (words[i] == "rms_m") pose.rms_m = *value;
  }
}

PosesOfFile read_tum(const std::filesystem::path& path, const std::vector<TextLine>& lines) {
  PosesOfFile file;
  CameraPose next;
  for (const TextLine& line : lines) {
    if (line.words.empty()) {
      read_comment(line.comment, next);
      continue;
    }
    const std::vector<double> n = numbers_in(path, line, 8, kTumLine);
    Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
    if (!(std::abs(q.norm() - 1) < kUnit))
      fail_at(path, line,
              fmt::format("the quaternion qx qy qz qw has length {:.6g}; expected 1", q.norm()));
    if (next.segment >= kMostSegments)
      fail_at(path, line,
              fmt::format("segment {}; expected a number below {}", next.segment, kMostSegments));
    // Keep quaternions that are unit to the last bits, so that reading and writing preserve a file.
    if (std::abs(q.norm() - 1) > 1e-12) q.normalize();
    next.timestamp_s = n[0];
    next.quaternion = {q.x(), q.y(), q.z(), q.w()};
    next.T_world_camera.translation() = Vec3d(n[1], n[2], n[3]);
    settle(next);
    file.add(next, line.number);
    next = {};
  }
  return file;
}

[[noreturn]] void fail_at_matrix(const std::filesystem::path& path, const TextLine& line) {
  fail_at(path, line, "the matrix is not a rigid transform");
}

PosesOfFile read_kitti(const std::filesystem::path& path, const std::vector<TextLine>& lines) {
  PosesOfFile file;
  for (const TextLine& line : lines) {
    if (line.words.empty()) continue;
    const auto pose = pose_of_matrix(numbers_in(path, line, 12, kKittiLine));
    if (!pose) fail_at_matrix(path, line);
    file.add({.timestamp_s = kNoTime, .T_world_camera = *pose}, line.number);
  }
  return file;
}

/// Open3D's .log: a line of three integers, then the four rows of T_world_camera.
PosesOfFile read_log(const std::filesystem::path& path, std::vector<TextLine> lines) {
  std::erase_if(lines, [](const TextLine& line) { return line.words.empty(); });
  PosesOfFile file;
  for (std::size_t i = 0; i < lines.size(); i += 5) {
    for (const double number : numbers_in(path, lines[i], 3, kLogHead))
      if (number != std::floor(number))
        fail_at(path, lines[i], fmt::format("found {}; expected {}", number, kLogHead));
    std::vector<double> matrix;
    for (std::size_t row = 1; row <= 4; ++row) {
      if (i + row >= lines.size()) fail_at(path, lines[i], "the pose has fewer than four rows");
      const auto numbers = numbers_in(path, lines[i + row], 4, kLogRow);
      matrix.insert(matrix.end(), numbers.begin(), numbers.end());
    }
    const auto pose = pose_of_matrix(matrix);
    if (!pose) fail_at_matrix(path, lines[i]);
    file.add({.timestamp_s = kNoTime, .T_world_camera = *pose}, lines[i].number);
  }
  return file;
}

/// Open3D's PinholeCameraTrajectory: `extrinsic` is T_camera_world in column-major order.
PosesOfFile read_open3d_json(const std::filesystem::path& path) {
  PosesOfFile file;
  file.unit = "entry";
  const auto json = read_json<nlohmann::ordered_json>(path, kMostBytes);
  read_place(path, json, [&](const JsonPlace& place) {
    place.at("parameters").each([&](const JsonPlace& entry) {
      std::array<double, 16> columns{};
      FieldReader fields(entry);
      fields("extrinsic", columns);
      const Eigen::Matrix4d rows = Eigen::Map<const Eigen::Matrix4d>(columns.data()).transpose();
      const auto pose = pose_of_matrix(std::span(rows.data(), columns.size()));
      if (!pose)
        entry.at("extrinsic").fail_kind("the 16 numbers of a rigid transform, column by column");
      file.add({.timestamp_s = kNoTime, .T_world_camera = pose->inverse()},
               static_cast<int>(file.poses.size()));
    });
  });
  return file;
}

void check_distances(const std::filesystem::path& path, const PosesOfFile& file) {
  for (std::size_t i = 0; i < file.poses.size(); ++i)
    if (const std::string far = too_far(file.poses[i].T_world_camera, file.poses[0].T_world_camera);
        !far.empty())
      throw Error(
          fmt::format("{}, {} {}: the pose is {}", path.string(), file.unit, file.at[i], far));
}

/// Poses for the same frame or time must be equal.
void check_repeats(const std::filesystem::path& path, const PosesOfFile& file) {
  const std::vector<CameraPose>& poses = file.poses;
  const bool by_frame = all_have_frames(poses);
  if (!by_frame && !std::isfinite(poses[0].timestamp_s)) return;
  const auto key = [&](std::size_t i) {
    return by_frame ? static_cast<double>(poses[i].frame) : poses[i].timestamp_s;
  };
  std::vector<std::size_t> order(poses.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, key);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const std::size_t i = order[k - 1], j = order[k];
    if (key(i) != key(j) || poses[i].T_world_camera.matrix() == poses[j].T_world_camera.matrix())
      continue;
    const std::string what = by_frame ? fmt::format("frame {}", poses[i].frame)
                                      : fmt::format("the time {} s", poses[i].timestamp_s);
    throw Error(fmt::format("{}, lines {} and {}: two different poses for {}; expected one",
                            path.string(), file.at[i], file.at[j], what));
  }
}

double usual_gap_s(std::vector<double> times) {
  std::ranges::sort(times);
  std::vector<double> gaps;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] > times[i - 1]) gaps.push_back(times[i] - times[i - 1]);
  if (gaps.empty()) return 0;
  std::ranges::nth_element(gaps, gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2));
  return gaps[gaps.size() / 2];
}

}  // namespace

double turn_deg(const Pose& motion) {
  const double cosine = std::clamp((motion.linear().trace() - 1) / 2, -1.0, 1.0);
  return std::acos(cosine) * 180 / std::numbers::pi;
}

void settle(CameraPose& pose) {
  auto& [x, y, z, w] = pose.quaternion;
  if (x == 0 && y == 0 && z == 0 && w == 0) {
    Eigen::Quaterniond q(pose.T_world_camera.linear());
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    pose.quaternion = {q.x(), q.y(), q.z(), q.w()};
  }
  pose.T_world_camera.linear() = Eigen::Quaterniond(w, x, y, z).toRotationMatrix();
}

std::string too_far(const Pose& pose, const Pose& first) {
  const auto far = [](double distance_m, double limit_m, const char* from) {
    return distance_m <= limit_m ? std::string()
                                 : fmt::format("{:.6g} m from {}; expected at most {:.0f} km",
                                               distance_m, from, limit_m / 1000);
  };
  const Vec3d place = pose.translation();
  const std::string found =
      far((place - first.translation()).stableNorm(), kFarthestPose_m, "the first pose");
  return found.empty() ? far(place.stableNorm(), kFarthestFromOrigin_m, "the world's origin")
                       : found;
}

Trajectory read_trajectory(const std::filesystem::path& path) {
  const std::vector<TextLine> lines = read_text_lines(path, kMostBytes);
  const auto first = std::ranges::find_if(lines, [](const auto& l) { return !l.words.empty(); });
  if (first == lines.end()) throw Error(path.string() + ": contains no poses");
  const std::size_t words = first->words.size();
  PosesOfFile file;
  if (first->words[0].starts_with('{'))
    file = read_open3d_json(path);
  else if (words == 12)
    file = read_kitti(path, lines);
  else if (words == 3)
    file = read_log(path, lines);
  else if (words == 8)
    file = read_tum(path, lines);
  else
    fail_at(path, *first,
            fmt::format("{}; expected TUM (8 numbers per line), KITTI (12), or Open3D's .log or "
                        ".json",
                        counted(words, "word")));
  if (file.poses.empty()) throw Error(path.string() + ": contains no poses");
  check_distances(path, file);
  check_repeats(path, file);
  return {path.string(), std::move(file.poses)};
}

std::string tum_text(const Trajectory& trajectory) {
  std::string text = fmt::format(
      "# poses of the camera (x right, y down, z forward) in the world (z up), by {}\n"
      "# timestamp tx ty tz qx qy qz qw\n",
      one_line(trajectory.source));
  for (const CameraPose& pose : trajectory.poses) {
    text += fmt::format("# frame {} segment {}", pose.frame, pose.segment);
    if (std::isfinite(pose.fitness)) text += fmt::format(" fitness {:.4f}", pose.fitness);
    if (std::isfinite(pose.rms_m)) text += fmt::format(" rms_m {:.5f}", pose.rms_m);
    const auto& [x, y, z, w] = pose.quaternion;
    const Vec3d t = pose.T_world_camera.translation();
    text += fmt::format("\n{} {} {} {} {} {} {} {}\n", pose.timestamp_s, t.x(), t.y(), t.z(), x, y,
                        z, w);
  }
  return text;
}

const CameraPose* pose_of(const Trajectory& trajectory, int frame) {
  const auto at = std::ranges::lower_bound(trajectory.poses, frame, {}, &CameraPose::frame);
  return at != trajectory.poses.end() && at->frame == frame ? &*at : nullptr;
}

double time_of(const io::Recording& recording, int frame) {
  try {
    return recording.timestamp_s(frame);
  } catch (const Error&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

bool frames_have_times(const io::Recording& recording) {
  for (int i = 0; i < recording.frame_count(); ++i)
    if (const double t = time_of(recording, i); !std::isnan(t) && t != 0) return true;
  return false;
}

namespace {

using PosesOfFrames = std::vector<std::optional<CameraPose>>;

PosesOfFrames poses_by_number(const Trajectory& trajectory, std::span<const int> frames) {
  const std::vector<CameraPose>& poses = trajectory.poses;
  std::unordered_map<int, std::size_t> of_frame;
  for (std::size_t k = 0; k < poses.size(); ++k) of_frame.emplace(poses[k].frame, k);
  PosesOfFrames found(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (const auto at = of_frame.find(frames[i]); at != of_frame.end())
      found[i] = poses[at->second];
  if (std::ranges::none_of(found, [](const auto& pose) { return pose.has_value(); }))
    throw Error(fmt::format(
        "{}: poses for frames {} to {}; expected poses for some of frames {} to {}",
        trajectory.source, poses.front().frame, poses.back().frame, frames.front(), frames.back()));
  return found;
}

/// Largest allowed difference between the times of a frame and its pose [s].
double most_apart_s(const std::vector<CameraPose>& poses) {
  std::vector<double> times;
  for (const CameraPose& pose : poses) times.push_back(pose.timestamp_s);
  return std::max(1e-4, usual_gap_s(std::move(times)) / 2);
}

/// The first frame whose time differs from that of the pose with its index, because frames were
/// added or removed.
std::optional<int> frame_at_another_time(const Trajectory& trajectory,
                                         const io::Recording& recording) {
  const double most_s = most_apart_s(trajectory.poses);
  const auto has_time = [](const CameraPose& pose) { return pose.timestamp_s != 0; };
  if (std::ranges::none_of(trajectory.poses, has_time)) return std::nullopt;
  for (const CameraPose& pose : trajectory.poses)
    if (pose.frame < recording.frame_count() &&
        std::abs(time_of(recording, pose.frame) - pose.timestamp_s) > most_s)
      return pose.frame;
  return std::nullopt;
}

/// The nearest pose of each frame, within half the usual distance between poses.
PosesOfFrames poses_by_time(const Trajectory& trajectory,
                            const io::Recording& recording,
                            std::span<const int> frames) {
  std::vector<CameraPose> sorted = trajectory.poses;
  std::ranges::stable_sort(sorted, {}, &CameraPose::timestamp_s);
  std::vector<double> times;
  for (const CameraPose& pose : sorted) times.push_back(pose.timestamp_s);
  const double reach = most_apart_s(sorted);
  PosesOfFrames found(frames.size());
  std::vector<int> frame_of(sorted.size(), -1);
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double t = time_of(recording, frames[i]);
    if (std::isnan(t)) continue;
    first_s = std::min(first_s, t);
    last_s = std::max(last_s, t);
    auto at = std::ranges::lower_bound(times, t) - times.begin();
    if (at > 0 && (at == std::ssize(times) || t - times[at - 1] < times[at] - t)) --at;
    if (!(std::abs(times[at] - t) <= reach)) continue;
    if (frame_of[at] >= 0)
      throw Error(
          fmt::format("{}: the pose at {} s is the nearest one to both frame {} and frame {}; "
                      "expected a pose for each frame, with times in seconds on the frames' clock",
                      trajectory.source, times[at], frame_of[at], frames[i]));
    frame_of[at] = frames[i];
    found[i] = sorted[at];
  }
  if (std::ranges::none_of(found, [](const auto& pose) { return pose.has_value(); }))
    throw Error(
        fmt::format("{}: no pose is close in time to a frame: poses are from {} s to {} s, frames "
                    "from {} s to {} s; "
                    "expected times in seconds on the frames' clock",
                    trajectory.source, times.front(), times.back(), first_s, last_s));
  return found;
}

}  // namespace

PairedPoses pair_poses(const Trajectory& trajectory,
                       const io::Recording& recording,
                       std::span<const int> frames) {
  const std::vector<CameraPose>& poses = trajectory.poses;
  const auto recorded = static_cast<std::size_t>(recording.frame_count());
  const bool have_times = frames_have_times(recording);
  const bool poses_have_times = std::isfinite(poses[0].timestamp_s);
  PairedPoses paired;
  const bool are_numbered = all_have_frames(poses);
  const std::optional<int> moved = are_numbered && poses_have_times && have_times
                                       ? frame_at_another_time(trajectory, recording)
                                       : std::nullopt;
  const auto last = std::ranges::max_element(poses, {}, &CameraPose::frame)->frame;
  if (are_numbered && !(poses_have_times && have_times) && last >= recording.frame_count())
    throw Error(fmt::format(
        "{}: contains a pose for frame {}, but {} has {} and no times to identify missing ones",
        trajectory.source, last, recording.info().path.string(), counted(recorded, "frame")));
  if (are_numbered && !moved) {
    paired.poses = poses_by_number(trajectory, frames);
  } else if (poses_have_times && have_times) {
    paired.poses = poses_by_time(trajectory, recording, frames);
    if (moved)
      paired.notice = fmt::format(
          "frame {} has a different time in {}; poses are paired by time, not by number", *moved,
          trajectory.source);
  } else {
    const bool of_all = poses.size() == recorded;
    if (!of_all && (poses_have_times || poses.size() != frames.size()))
      throw Error(fmt::format(
          "{}: {}{}; expected {}, one for each frame in {}{}", trajectory.source,
          counted(poses.size(), "pose"), poses_have_times ? "" : " without times", recorded,
          recording.info().path.string(), have_times ? "" : ", whose frames have no times"));
    for (std::size_t i = 0; i < frames.size(); ++i)
      paired.poses.emplace_back(poses[of_all ? static_cast<std::size_t>(frames[i]) : i]);
    if (poses_have_times)
      paired.notice =
          fmt::format("frames have no times: pose i in {} is used for frame i", trajectory.source);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!paired.poses[i]) continue;
    CameraPose& pose = *paired.poses[i];
    pose.frame = frames[i];
    if (have_times || !poses_have_times) {
      const double t = time_of(recording, frames[i]);
      if (std::isfinite(t))
        pose.timestamp_s = t;
      else if (!poses_have_times)
        pose.timestamp_s = 0;
    }
  }
  return paired;
}

}  // namespace planescope::world
