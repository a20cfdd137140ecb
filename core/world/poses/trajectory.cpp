#include "core/world/poses/trajectory.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <sstream>
#include <unordered_map>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::world {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;
constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
constexpr double kUnit = 1e-3;  // how far from a rotation a matrix or quaternion may be

struct TextLine {
  int number = 0;  // from 1
  std::string text;
};

[[noreturn]] void fail(const std::filesystem::path& path, int line, const std::string& what) {
  throw Error(fmt::format("{}, line {}: {}", path.string(), line, what));
}

/// The numbers of a line; nullopt where a word is none.
std::optional<std::vector<double>> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(text)) {
    const std::optional<double> number = parse_number(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// Row-major 3x4 or 4x4. Empty: no rigid motion.
std::optional<Pose> pose_of_matrix(std::span<const double> m) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = m[row * 4 + column];
  const Mat3d r = pose.linear();
  if (!((r * r.transpose() - Mat3d::Identity()).norm() < 10 * kUnit) || r.determinant() < 0)
    return std::nullopt;
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  return pose;
}

/// tx ty tz qx qy qz qw. False: the quaternion is not of unit length.
bool place(std::span<const double> n, CameraPose& pose) {
  Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (!(std::abs(q.norm() - 1) < kUnit)) return false;
  // What is a unit to the last bits stays as it is: a file that was read and written is the same.
  if (std::abs(q.norm() - 1) > 1e-12) q.normalize();
  pose.quaternion = {q.x(), q.y(), q.z(), q.w()};
  pose.T_world_camera.translation() = Vec3d(n[0], n[1], n[2]);
  settle(pose);
  return true;
}

/// "# frame 12 segment 0 fitness 0.93 rms_m 0.0031": of the pose that follows.
void read_comment(const std::string& text, CameraPose& pose) {
  const std::vector<std::string> words = words_of(text);
  for (std::size_t i = 1; i + 1 < words.size(); i += 2) {
    const std::optional<double> value = parse_number(words[i + 1]);
    if (!value) return;
    const bool is_whole = std::abs(*value) < 1e9 && *value == std::floor(*value) && *value >= 0;
    if (words[i] == "frame" && is_whole) pose.frame = static_cast<int>(*value);
    if (words[i] == "segment" && is_whole) pose.segment = static_cast<int>(*value);
    if (words[i] == "fitness") pose.fitness = *value;
    if (words[i] == "rms_m") pose.rms_m = *value;
  }
}

std::vector<CameraPose> read_tum(const std::filesystem::path& path,
                                 const std::vector<TextLine>& lines) {
  std::vector<CameraPose> poses;
  CameraPose next;
  for (const TextLine& line : lines) {
    if (line.text[0] == '#') {
      read_comment(line.text, next);
      continue;
    }
    const auto numbers = numbers_of(line.text);
    if (!numbers || numbers->size() != 8)
      fail(path, line.number,
           "expected the eight numbers of a TUM trajectory, timestamp tx ty tz qx qy qz qw");
    if (!place(std::span(*numbers).subspan(1), next))
      fail(path, line.number, "the quaternion qx qy qz qw is not of length 1");
    next.timestamp_s = (*numbers)[0];
    poses.push_back(next);
    next = {};
  }
  return poses;
}

std::vector<CameraPose> read_kitti(const std::filesystem::path& path,
                                   const std::vector<TextLine>& lines) {
  std::vector<CameraPose> poses;
  for (const TextLine& line : lines) {
    if (line.text[0] == '#') continue;
    const auto numbers = numbers_of(line.text);
    if (!numbers || numbers->size() != 12)
      fail(path, line.number, "expected the twelve numbers of a KITTI pose, a matrix of 3x4");
    const auto pose = pose_of_matrix(*numbers);
    if (!pose) fail(path, line.number, "the matrix is no rotation and shift");
    poses.push_back({.timestamp_s = kNoTime, .T_world_camera = *pose});
  }
  return poses;
}

/// Open3D's .log: a line of three whole numbers, then the four rows of T_world_camera.
std::vector<CameraPose> read_log(const std::filesystem::path& path,
                                 const std::vector<TextLine>& lines) {
  std::vector<CameraPose> poses;
  for (std::size_t i = 0; i < lines.size(); i += 5) {
    std::vector<double> matrix;
    for (std::size_t row = 1; row <= 4; ++row) {
      if (i + row >= lines.size())
        fail(path, lines[i].number, "the pose ends before its four rows");
      const auto numbers = numbers_of(lines[i + row].text);
      if (!numbers || numbers->size() != 4)
        fail(path, lines[i + row].number, "expected the four numbers of a matrix's row");
      matrix.insert(matrix.end(), numbers->begin(), numbers->end());
    }
    const auto pose = pose_of_matrix(matrix);
    if (!pose) fail(path, lines[i].number, "the matrix is no rotation and shift");
    poses.push_back({.timestamp_s = kNoTime, .T_world_camera = *pose});
  }
  return poses;
}

/// Open3D's PinholeCameraTrajectory: `extrinsic` is T_camera_world, column by column.
std::vector<CameraPose> read_open3d_json(const std::filesystem::path& path) {
  const auto json = read_json<nlohmann::json>(path, kMostBytes);
  const auto parameters = json.is_object() ? json.find("parameters") : json.end();
  if (!json.is_object() || parameters == json.end() || !parameters->is_array())
    throw Error(path.string() + ": has no list 'parameters', as Open3D's trajectories have");
  std::vector<CameraPose> poses;
  for (const auto& parameter : *parameters) {
    const auto extrinsic = parameter.is_object() ? parameter.find("extrinsic") : parameter.end();
    std::array<double, 16> m{};
    bool fine = parameter.is_object() && extrinsic != parameter.end() && extrinsic->is_array() &&
                extrinsic->size() == m.size();
    for (std::size_t i = 0; fine && i < m.size(); ++i) {
      fine = (*extrinsic)[i].is_number();
      if (fine) m[i % 4 * 4 + i / 4] = (*extrinsic)[i].get<double>();
    }
    const auto pose = fine ? pose_of_matrix(m) : std::nullopt;
    if (!pose)
      throw Error(
          fmt::format("{}: 'extrinsic' of entry {} is no matrix of 16 numbers that rotates "
                      "and shifts",
                      path.string(), poses.size()));
    poses.push_back({.timestamp_s = kNoTime, .T_world_camera = pose->inverse()});
  }
  return poses;
}

std::vector<TextLine> lines_of(const std::string& text) {
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin != std::string::npos) lines.push_back({number, line.substr(begin)});
  }
  return lines;
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

Trajectory read_trajectory(const std::filesystem::path& path) {
  Trajectory trajectory{path.string(), {}};
  const std::vector<unsigned char> bytes = read_file_bytes(path, kMostBytes);
  const std::string text(bytes.begin(), bytes.end());
  const std::vector<TextLine> lines = lines_of(text);
  const auto first = std::ranges::find_if(lines, [](const auto& l) { return l.text[0] != '#'; });
  if (first == lines.end()) throw Error(path.string() + ": holds no pose");
  const auto numbers = numbers_of(first->text);
  if (first->text[0] == '{')
    trajectory.poses = read_open3d_json(path);
  else if (numbers && numbers->size() == 12)
    trajectory.poses = read_kitti(path, lines);
  else if (numbers && numbers->size() == 3)
    trajectory.poses = read_log(path, lines);
  else if (numbers && numbers->size() == 8)
    trajectory.poses = read_tum(path, lines);
  else
    fail(path, first->number,
         "no trajectory: expected TUM (8 numbers a line), KITTI (12), or Open3D's .log or .json");
  if (trajectory.poses.empty()) throw Error(path.string() + ": holds no pose");
  return trajectory;
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

std::vector<std::optional<CameraPose>> poses_of_frames(const Trajectory& trajectory,
                                                       const std::vector<FrameTime>& frames,
                                                       int recorded) {
  const std::vector<CameraPose>& poses = trajectory.poses;
  std::vector<std::optional<CameraPose>> found(frames.size());
  const auto take = [&](std::size_t i, const CameraPose& pose) {
    found[i] = pose;
    found[i]->frame = frames[i].frame;
    found[i]->timestamp_s = frames[i].timestamp_s;
  };
  if (std::ranges::any_of(poses, [](const auto& p) { return p.frame >= 0; })) {
    std::unordered_map<int, std::size_t> of_frame;
    for (std::size_t k = 0; k < poses.size(); ++k) of_frame.emplace(poses[k].frame, k);
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (const auto at = of_frame.find(frames[i].frame); at != of_frame.end())
        take(i, poses[at->second]);
  } else if (!std::isfinite(poses[0].timestamp_s)) {
    // One for each frame that is asked for, or of the recording as a whole.
    const bool of_all = std::ssize(poses) == recorded;
    if (!of_all && poses.size() != frames.size())
      throw Error(fmt::format("{}: {} without times, for {}: expected as many", trajectory.source,
                              counted(poses.size(), "pose"), counted(frames.size(), "frame")));
    for (std::size_t i = 0; i < frames.size(); ++i)
      take(i, poses[of_all ? static_cast<std::size_t>(frames[i].frame) : i]);
  } else {
    std::vector<CameraPose> sorted = poses;
    std::ranges::stable_sort(sorted, {}, &CameraPose::timestamp_s);
    std::vector<double> times;
    for (const CameraPose& pose : sorted) times.push_back(pose.timestamp_s);
    const double reach = std::max(1e-4, usual_gap_s(times) / 2);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double t = frames[i].timestamp_s;
      auto at = std::ranges::lower_bound(times, t) - times.begin();
      if (at > 0 && (at == std::ssize(times) || t - times[at - 1] < times[at] - t)) --at;
      if (std::abs(times[at] - t) <= reach) take(i, sorted[at]);
    }
  }
  if (std::ranges::none_of(found, [](const auto& p) { return p.has_value(); }))
    throw Error(fmt::format(
        "{}: no pose is of any of the frames: poses from {} s to {} s, frames from {} s to {} s",
        trajectory.source, poses.front().timestamp_s, poses.back().timestamp_s,
        frames.front().timestamp_s, frames.back().timestamp_s));
  return found;
}

}  // namespace planescope::world
