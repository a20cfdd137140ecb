// Sidecars of recordings, picked gravity, and the camera settings that follow from them.

#include "core/io/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"

namespace planescope::io {

namespace fs = std::filesystem;

namespace {

/// Reads exactly `kCount` finite numbers.
template <int kCount>
Eigen::Vector<double, kCount> read_numbers(const JsonPlace& place, const char* expected) {
  Eigen::Vector<double, kCount> numbers;
  int i = 0;
  place.each([&](const JsonPlace& one) {
    if (i < kCount) numbers[i] = one.number();
    ++i;
  });
  if (i != kCount || !numbers.allFinite()) place.fail_kind(expected);
  return numbers;
}

std::optional<Vec3d> read_direction(const JsonPlace& place) {
  constexpr const char* kExpected = "three numbers [x, y, z] that are not all zero";
  if (!place.has("gravity")) return std::nullopt;
  const Vec3d vector = read_numbers<3>(place.at("gravity"), kExpected);
  if (vector.stableNorm() < 1e-9) place.at("gravity").fail_kind(kExpected);
  // Keep every bit of a direction that we wrote.
  return std::abs(vector.squaredNorm() - 1) < 1e-14 ? vector : vector.stableNormalized();
}

void read_side(const JsonPlace& place, const char* key, int& side) {
  if (!place.has(key)) return;
  const double value = place.at(key).number();
  if (!(value >= 0 && value <= 1e6) || value != std::floor(value))
    place.at(key).fail_kind("a whole number of pixels");
  side = static_cast<int>(value);
}

Intrinsics read_intrinsics(const JsonPlace& place) {
  Intrinsics k;
  std::vector<double> coefficients;
  std::string model = "brown_conrady";
  read_side(place, "width", k.width);
  read_side(place, "height", k.height);
  FieldReader fields(place);
  fields("fx", k.fx);
  fields("fy", k.fy);
  fields("cx", k.cx);
  fields("cy", k.cy);
  fields("distortion", coefficients, kOptional);
  fields("distortion_model", model, kOptional);
  if (!set_distortion(model, coefficients, k))
    place.fail_kind(
        "\"distortion_model\": \"brown_conrady\" or \"inverse_brown_conrady\", with up to "
        "five numbers [k1, k2, p1, p2, k3]");
  return k;
}

std::optional<Pose> read_world_pose(const JsonPlace& place) {
  constexpr const char* kExpected = "tx ty tz and a unit quaternion qx qy qz qw";
  if (!place.has("T_world_camera")) return std::nullopt;
  const auto n = read_numbers<7>(place.at("T_world_camera"), kExpected);
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (!(std::abs(q.norm() - 1) < 1e-3)) place.at("T_world_camera").fail_kind(kExpected);
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = n.head<3>();
  return pose;
}

Pose read_rigid(const JsonPlace& place) {
  constexpr const char* kExpected = "the 16 numbers of a rigid transform, row by row";
  const auto numbers = read_numbers<16>(place, kExpected);
  Pose pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Mat3d turn = pose.linear();
  if (!(turn * turn.transpose()).isApprox(Mat3d::Identity(), 1e-4) || turn.determinant() < 0 ||
      pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    place.fail_kind(kExpected);
  return pose;
}

/// The sidecar inside a folder; empty if there is none.
fs::path sidecar_inside(const fs::path& recording) {
  std::error_code ignored;
  if (!fs::is_directory(recording, ignored)) return {};
  for (const char* name : {"planescope.json", "gravity.json"})
    if (fs::exists(recording / name, ignored)) return recording / name;
  return {};
}

}  // namespace

Sidecar sidecar_of(const JsonPlace& place, const fs::path& path) {
  Sidecar sidecar;
  sidecar.path = path;
  if (place.has("intrinsics")) {
    sidecar.intrinsics = read_intrinsics(place.at("intrinsics"));
    sidecar.intrinsics_source = path.filename().string();
  }
  FieldReader fields(place);
  fields("depth_unit_m", sidecar.depth_unit_m, kOptional);
  if (sidecar.depth_unit_m && !(*sidecar.depth_unit_m > 0))
    place.at("depth_unit_m").fail_kind("more than 0 meters per count");
  sidecar.gravity = read_direction(place);
  fields("color_aligned", sidecar.color_aligned, kOptional);
  if (place.has("color")) {
    sidecar.color_intrinsics = read_intrinsics(place.at("color").at("intrinsics"));
    sidecar.T_color_depth = read_rigid(place.at("color").at("T_color_depth"));
  }
  fields.list("frames", sidecar.frames, kOptional, [](FieldReader& of, Sidecar::FrameFacts& frame) {
    of("name", frame.name);
    of("timestamp_s", frame.timestamp_s, kOptional);
    frame.gravity = read_direction(of.place());
    frame.T_world_camera = read_world_pose(of.place());
  });
  for (std::size_t i = 0; i < sidecar.frames.size(); ++i)
    sidecar.frame_of.emplace(sidecar.frames[i].name, i);
  return sidecar;
}

namespace {

Sidecar read_one_sidecar(const fs::path& path) {
  return read_place(path, read_json<nlohmann::ordered_json>(path), [&](const JsonPlace& place) {
    if (place.has("schema")) place.schema({"planescope.recording/1"});
    return sidecar_of(place, path);
  });
}

}  // namespace

fs::path sidecar_beside(const fs::path& recording) {
  return path_beside(recording, ".planescope.json");
}

Sidecar read_sidecar(const fs::path& recording) {
  const fs::path inside = sidecar_inside(recording), beside = sidecar_beside(recording);
  std::error_code ignored;
  if (!fs::exists(beside, ignored)) return inside.empty() ? Sidecar{} : read_one_sidecar(inside);
  Sidecar sidecar = read_one_sidecar(beside);
  if (inside.empty()) return sidecar;
  Sidecar rest = read_one_sidecar(inside);
  if (!sidecar.intrinsics) {
    sidecar.intrinsics = rest.intrinsics;
    sidecar.intrinsics_source = rest.intrinsics_source;
  }
  if (!sidecar.depth_unit_m) sidecar.depth_unit_m = rest.depth_unit_m;
  if (!sidecar.gravity) sidecar.gravity = rest.gravity;
  if (!sidecar.color_aligned) sidecar.color_aligned = rest.color_aligned;
  if (!sidecar.color_intrinsics) {
    sidecar.color_intrinsics = rest.color_intrinsics;
    sidecar.T_color_depth = rest.T_color_depth;
  }
  if (sidecar.frames.empty()) {
    sidecar.frames = std::move(rest.frames);
    sidecar.frame_of = std::move(rest.frame_of);
    sidecar.path = rest.path;
  }
  return sidecar;
}

const Sidecar::FrameFacts* facts_of(const Sidecar& sidecar, const std::string& name) {
  const auto at = sidecar.frame_of.find(name);
  return at == sidecar.frame_of.end() ? nullptr : &sidecar.frames[at->second];
}

nlohmann::ordered_json intrinsics_json(const Intrinsics& k) {
  nlohmann::ordered_json camera = {{"width", k.width}, {"height", k.height}, {"fx", k.fx},
                                   {"fy", k.fy},       {"cx", k.cx},         {"cy", k.cy}};
  camera["distortion"] = k.coefficients;
  if (k.distortion == Distortion::inverse_brown_conrady)
    camera["distortion_model"] = to_string(k.distortion);
  return camera;
}

std::array<double, 7> pose_numbers(const Pose& pose) {
  const Vec3d t = pose.translation();
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

void apply_sidecar(const Sidecar& sidecar, Frame& frame) {
  std::optional<Vec3d> direction = sidecar.gravity;
  if (const Sidecar::FrameFacts* facts = facts_of(sidecar, frame.name)) {
    if (facts->gravity) direction = facts->gravity;
    if (facts->timestamp_s) frame.timestamp_s = *facts->timestamp_s;
    if (facts->T_world_camera) frame.T_world_camera = facts->T_world_camera;
  }
  if (direction) {
    frame.gravity =
        Gravity{*direction, GravitySource::sidecar, 1, "from " + sidecar.path.filename().string()};
  }
}

double time_of_frame(const Sidecar& sidecar, const std::string& name, double own_s) {
  const Sidecar::FrameFacts* facts = facts_of(sidecar, name);
  return facts ? facts->timestamp_s.value_or(own_s) : own_s;
}

bool has_times(const Sidecar& sidecar) {
  return std::ranges::any_of(sidecar.frames, [](const Sidecar::FrameFacts& frame) {
    return frame.timestamp_s.value_or(0) != 0;
  });
}

std::optional<Gravity> gravity_of_accelerometer(const Vec3d& mean_m_s2,
                                                std::size_t samples,
                                                double within_s) {
  constexpr double kLeast = 7, kMost = 13;  // [m/s2]
  const double length = mean_m_s2.norm();
  if (!(length >= kLeast && length <= kMost)) return std::nullopt;
  return Gravity{-mean_m_s2.normalized(), GravitySource::imu, 1,
                 fmt::format("mean of {} accelerometer samples within {:.2f} s, {:.2f} m/s2",
                             samples, within_s, length)};
}

namespace {

bool usable(const Intrinsics& k) {
  return std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy) &&
         k.fx > 0 && k.fy > 0;
}

}  // namespace

void settle_camera(const RecordingOptions& options,
                   const Sidecar& sidecar,
                   const CameraFacts& facts,
                   RecordingInfo& info) {
  const std::string path = info.path.string();
  if (options.intrinsics) {
    const auto& [fx, fy, cx, cy] = *options.intrinsics;
    info.intrinsics = {0, 0, fx, fy, cx, cy, Distortion::none, {}};
    info.intrinsics_source = "option --intrinsics";
  } else if (sidecar.intrinsics) {
    info.intrinsics = *sidecar.intrinsics;
    info.intrinsics_source = sidecar.intrinsics_source;
  } else if (facts.intrinsics) {
    info.intrinsics = *facts.intrinsics;
    info.intrinsics_source = facts.intrinsics_source;
  } else if (!options.intrinsics_may_lack) {
    std::string ignored;
    if (!info.ignored_calibration.empty())
      ignored = fmt::format(" ({}: {})", info.ignored_calibration.front(), kNotACalibration);
    throw Error(fmt::format("{}: the recording contains no camera intrinsics{}; {}", path, ignored,
                            kHowToGiveIntrinsics));
  }
  Intrinsics& k = info.intrinsics;
  if (!info.intrinsics_source.empty() && !usable(k))
    throw Error(
        fmt::format("{}: intrinsics fx {:f}, fy {:f} from {} are invalid; expected positive focal "
                    "lengths in pixels",
                    path, k.fx, k.fy, info.intrinsics_source));
  if (k.width > 0 && k.height > 0 && (k.width != info.width || k.height != info.height))
    throw Error(fmt::format("{}: depth images are {}x{}, but the intrinsics in {} are for {}x{}",
                            path, info.width, info.height, info.intrinsics_source, k.width,
                            k.height));
  k.width = info.width;
  k.height = info.height;
  // In a cropped image it may be slightly outside.
  if (std::abs(k.cx - 0.5 * k.width) > k.width || std::abs(k.cy - 0.5 * k.height) > k.height)
    throw Error(fmt::format(
        "{}: principal point cx {:g}, cy {:g} from {} is far outside the {}x{} depth image", path,
        k.cx, k.cy, info.intrinsics_source, info.width, info.height));

  if (options.depth_unit_m) {
    info.depth_unit_m = *options.depth_unit_m;
    info.depth_unit_source = "option --depth-unit";
  } else if (sidecar.depth_unit_m) {
    info.depth_unit_m = *sidecar.depth_unit_m;
    info.depth_unit_source = sidecar.path.filename().string();
  } else if (facts.depth_unit_m) {
    info.depth_unit_m = *facts.depth_unit_m;
    info.depth_unit_source = facts.depth_unit_source;
  } else {
    info.depth_unit_m = 0.001;
    info.depth_unit_source = "assumed (RealSense default)";
  }
  if (!(info.depth_unit_m > 0) || !std::isfinite(info.depth_unit_m))
    throw Error(fmt::format(
        "{}: depth unit {:f} m from {} is invalid; expected more than 0 meters per count", path,
        info.depth_unit_m, info.depth_unit_source));
}

bool set_distortion(const std::string& model,
                    const std::vector<double>& coefficients,
                    Intrinsics& intrinsics) {
  intrinsics.distortion = Distortion::none;
  intrinsics.coefficients = {};
  const auto are_zero = [&](std::size_t from) {
    return std::all_of(coefficients.begin() + static_cast<std::ptrdiff_t>(from), coefficients.end(),
                       [](double c) { return c == 0; });
  };
  if (are_zero(0)) return true;
  const std::string lower = lower_case(model);
  const auto names = [&](const char* part) { return lower.find(part) != std::string::npos; };
  const bool finite = std::ranges::all_of(coefficients, [](double c) { return std::isfinite(c); });
  // More than five coefficients are a rational model, which Intrinsics does not support.
  const bool five = coefficients.size() <= 5 || are_zero(5);
  if (!finite || !five || !(names("brown") || names("plumb"))) return false;
  std::copy_n(coefficients.begin(), std::min<std::size_t>(5, coefficients.size()),
              intrinsics.coefficients.begin());
  intrinsics.distortion =
      names("inverse") ? Distortion::inverse_brown_conrady : Distortion::brown_conrady;
  return true;
}

std::string sha256_of_depth(const Image16& depth) {
  return sha256_hex(std::as_bytes(std::span(depth.data)));
}

void expect_regular_file(const fs::path& path) {
  std::error_code failed;
  const fs::file_type type = fs::status(path, failed).type();
  if (type == fs::file_type::regular) return;
  throw Error(fmt::format("{}: is {}; expected a file", path.string(),
                          type == fs::file_type::directory   ? "a folder"
                          : type != fs::file_type::not_found ? "a pipe or device"
                          : fs::is_symlink(path, failed)     ? "a link to a missing file"
                                                             : "missing"));
}

void find_damaged_frames(std::size_t frames,
                         RecordingInfo& info,
                         const std::function<void(std::size_t)>& check) {
  for (std::size_t i = 0; i < frames; ++i) {
    try {
      check(i);
    } catch (const Error& error) {
      info.damaged[static_cast<int>(i)] = error.what();
    }
  }
  if (info.damaged.size() == frames) throw Error(info.damaged.begin()->second);
}

void expect_undamaged(const RecordingInfo& info, int i) {
  if (const auto found = info.damaged.find(i); found != info.damaged.end())
    throw Error(found->second);
}

// ---- Picked gravity ----

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kGravitySchema = "planescope.gravity/1";

fs::path file_in(const fs::path& label_dir) { return label_dir / "gravity.json"; }

void expect_unit(Vec3d& direction, const JsonPlace& place) {
  if (!direction.allFinite() || std::abs(direction.norm() - 1) > 1e-3)
    place.fail_kind("a vector of length 1");
  direction.normalize();
}

}  // namespace

template <typename Fields>
void visit_fields(Fields& fields, Same<PickedDirection> auto& picked) {
  fields("direction", picked.direction);
  fields("walls", picked.walls);
  fields("frame", picked.frame);
  fields("frame_sha256", picked.frame_sha256);
  fields("note", picked.note);
  if constexpr (Fields::kReads) {
    expect_unit(picked.direction, fields.place().at("direction"));
    for (Vec3d& wall : picked.walls) expect_unit(wall, fields.place().at("walls"));
  }
}

template <typename Fields>
void visit_fields(Fields& fields, Same<PickedGravity> auto& picked) {
  fields("recording", picked.recording);
  std::vector<PickedDirection> frames;
  for (const auto& [index, direction] : picked.frames) frames.push_back(direction);
  fields("frames", frames);
  if constexpr (Fields::kReads)
    for (PickedDirection& direction : frames) picked.frames[direction.frame] = std::move(direction);
}

namespace {

/// Finds the clicked frames by their hashes: like labels, a direction is valid only there.
void find_picked_frames(const Recording& recording, PickedGravity& picked) {
  std::vector<PickedDirection> all;
  if (picked.recording) all.push_back(*picked.recording);
  for (const auto& [index, direction] : picked.frames) all.push_back(direction);
  std::vector<FrameIdentity> wanted;
  for (const PickedDirection& one : all) wanted.push_back({one.frame, one.frame_sha256, {}, 0});
  const auto found = find_frames(recording, wanted);
  picked.frames.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!found[i])
      throw Error("was picked on a different recording (frame " + std::to_string(all[i].frame) +
                  " differs); delete it, or specify the recording's label folder with --labels");
    all[i].frame = *found[i];
    if (picked.recording && i == 0)
      picked.recording = all[i];
    else
      picked.frames[*found[i]] = all[i];
  }
}

}  // namespace

const PickedDirection* PickedGravity::of(int frame) const {
  const auto own = frames.find(frame);
  if (own != frames.end()) return &own->second;
  return recording ? &*recording : nullptr;
}

PickedGravity read_picked_gravity(const fs::path& label_dir, const Recording& recording) {
  const fs::path file = file_in(label_dir);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  return read_place(file, read_json<Json>(file), [&](const JsonPlace& place) {
    place.schema({kGravitySchema});
    PickedGravity picked;
    read_fields(place, picked);
    find_picked_frames(recording, picked);
    return picked;
  });
}

void write_picked_gravity(const fs::path& label_dir, const PickedGravity& picked) {
  const fs::path file = file_in(label_dir);
  std::error_code failed;
  if (picked.empty()) {
    fs::remove(file, failed);
    if (failed) throw Error(file.string() + ": cannot be removed: " + failed.message());
    return;
  }
  Json json = {{"schema", kGravitySchema}};
  json.update(json_of(picked));
  fs::create_directories(label_dir, failed);
  if (failed) throw Error(label_dir.string() + ": cannot be created: " + failed.message());
  write_file_text(file, json_text(json, 2), Durable::yes);
}

void apply_picked_gravity(const PickedGravity& picked, Frame& frame) {
  const PickedDirection* direction = picked.of(frame.index);
  if (direction && !frame.gravity)
    frame.gravity = Gravity{direction->direction, GravitySource::picked, 1, direction->note};
}

std::shared_ptr<const Recording> with_picked_gravity(std::shared_ptr<const Recording> recording,
                                                     PickedGravity picked) {
  if (picked.empty()) return recording;
  return with_changed_frames(std::move(recording), [picked = std::move(picked)](Frame& frame) {
    apply_picked_gravity(picked, frame);
  });
}

}  // namespace planescope::io
