#include "core/io/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/sha256.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

using nlohmann::json;

struct Keys {
  const std::filesystem::path& path;

  [[noreturn]] void fail(const std::string& key, const std::string& expected) const {
    throw Error(path.string() + ": \"" + key + "\" is not usable, expected " + expected);
  }

  double number(const json& object, const std::string& key) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number()) fail(key, "a number");
    return found->get<double>();
  }

  int pixels(const json& object, const std::string& key) const {
    const double value = number(object, key);
    if (!(value >= 0 && value <= 1e6) || value != std::floor(value))
      fail(key, "a whole number of pixels");
    return static_cast<int>(value);
  }

  std::optional<Vec3d> direction(const json& object) const {
    const auto found = object.find("gravity");
    if (found == object.end() || found->is_null()) return std::nullopt;
    Vec3d vector = Vec3d::Zero();
    bool usable = found->is_array() && found->size() == 3;
    for (std::size_t i = 0; usable && i < 3; ++i) {
      usable = (*found)[i].is_number();
      if (usable) vector[i] = (*found)[i].get<double>();
    }
    if (!usable || !vector.allFinite() || vector.stableNorm() < 1e-9) {
      fail("gravity", "three numbers [x, y, z] that are not all zero");
    }
    // Of a direction that was written by us not a bit changes.
    return std::abs(vector.squaredNorm() - 1) < 1e-14 ? vector : vector.stableNormalized();
  }

  Intrinsics intrinsics(const json& object) const {
    if (!object.is_object()) fail("intrinsics", "an object with fx, fy, cx, cy");
    Intrinsics result;
    if (object.contains("width")) result.width = pixels(object, "width");
    if (object.contains("height")) result.height = pixels(object, "height");
    result.fx = number(object, "fx");
    result.fy = number(object, "fy");
    result.cx = number(object, "cx");
    result.cy = number(object, "cy");
    std::vector<double> coefficients;
    for (const json& value : object.value("distortion", json::array())) {
      if (!value.is_number()) fail("distortion", "numbers [k1, k2, p1, p2, k3]");
      coefficients.push_back(value.get<double>());
    }
    const json model = object.value("distortion_model", json("brown_conrady"));
    if (!model.is_string() || !set_distortion(model.get<std::string>(), coefficients, result))
      fail("distortion_model",
           "\"brown_conrady\" or \"inverse_brown_conrady\" with up to five numbers");
    return result;
  }

  std::optional<Pose> placed(const json& object) const {
    constexpr double kUnit = 1e-3;
    const auto found = object.find("T_world_camera");
    if (found == object.end() || found->is_null()) return std::nullopt;
    double n[7] = {};
    bool usable = found->is_array() && found->size() == 7;
    for (std::size_t i = 0; usable && i < 7; ++i) {
      usable = (*found)[i].is_number();
      if (usable) n[i] = (*found)[i].get<double>();
    }
    const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
    Pose pose = Pose::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = Vec3d(n[0], n[1], n[2]);
    if (!usable || !(std::abs(q.norm() - 1) < kUnit) || !pose.matrix().allFinite())
      fail("T_world_camera", "tx ty tz and a quaternion qx qy qz qw of length 1");
    return pose;
  }

  Pose pose(const json& object, const std::string& key) const {
    const auto found = object.find(key);
    Pose pose = Pose::Identity();
    bool usable = found != object.end() && found->is_array() && found->size() == 16;
    for (std::size_t i = 0; usable && i < 16; ++i) {
      usable = (*found)[i].is_number();
      if (usable)
        pose.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) = (*found)[i].get<double>();
    }
    const Mat3d turn = pose.linear();
    if (!usable || !pose.matrix().allFinite() ||
        !(turn * turn.transpose()).isApprox(Mat3d::Identity(), 1e-4) || turn.determinant() < 0 ||
        pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      fail(key, "16 numbers of a rigid motion, row by row");
    return pose;
  }
};

/// The sidecar inside a folder; empty if there is none.
std::filesystem::path sidecar_inside(const std::filesystem::path& recording) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(recording, ignored)) return {};
  for (const char* name : {"planescope.json", "gravity.json"})
    if (std::filesystem::exists(recording / name, ignored)) return recording / name;
  return {};
}

Sidecar read_one_sidecar(const std::filesystem::path& path) {
  Sidecar sidecar;
  sidecar.path = path;
  const json document = read_json<nlohmann::json>(sidecar.path);
  const Keys keys{sidecar.path};
  if (!document.is_object()) throw Error(sidecar.path.string() + ": expected a JSON object");
  if (document.contains("schema") && document["schema"] != "planescope.recording/1") {
    keys.fail("schema", "\"planescope.recording/1\"");
  }
  if (document.contains("intrinsics")) {
    sidecar.intrinsics = keys.intrinsics(document["intrinsics"]);
    sidecar.intrinsics_source = path.filename().string();
  }
  if (document.contains("depth_unit_m")) {
    sidecar.depth_unit_m = keys.number(document, "depth_unit_m");
    if (!(*sidecar.depth_unit_m > 0)) keys.fail("depth_unit_m", "metres per count above 0");
  }
  sidecar.gravity = keys.direction(document);
  if (document.contains("color_aligned")) {
    if (!document["color_aligned"].is_boolean()) keys.fail("color_aligned", "true or false");
    sidecar.color_aligned = document["color_aligned"].get<bool>();
  }
  if (document.contains("color")) {
    if (!document["color"].is_object())
      keys.fail("color", "an object with intrinsics and T_color_depth");
    sidecar.color_intrinsics = keys.intrinsics(document["color"].value("intrinsics", json()));
    sidecar.T_color_depth = keys.pose(document["color"], "T_color_depth");
  }
  if (!document.contains("frames")) return sidecar;
  if (!document["frames"].is_array()) keys.fail("frames", "a list");
  for (const json& entry : document["frames"]) {
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string()) {
      keys.fail("frames", "objects with a \"name\"");
    }
    Sidecar::FrameFacts frame;
    frame.name = entry["name"].get<std::string>();
    if (entry.contains("timestamp_s")) frame.timestamp_s = keys.number(entry, "timestamp_s");
    frame.gravity = keys.direction(entry);
    frame.T_world_camera = keys.placed(entry);
    sidecar.frame_of.emplace(frame.name, sidecar.frames.size());
    sidecar.frames.push_back(std::move(frame));
  }
  return sidecar;
}

}  // namespace

std::filesystem::path sidecar_beside(const std::filesystem::path& recording) {
  return path_beside(recording, ".planescope.json");
}

Sidecar read_sidecar(const std::filesystem::path& recording) {
  const std::filesystem::path inside = sidecar_inside(recording),
                              beside = sidecar_beside(recording);
  std::error_code ignored;
  if (!std::filesystem::exists(beside, ignored))
    return inside.empty() ? Sidecar{} : read_one_sidecar(inside);
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

bool tells_times(const Sidecar& sidecar) {
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

constexpr double kRealSenseUnit_m = 0.001;

bool usable(const Intrinsics& k) {
  return std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy) &&
         k.fx > 0 && k.fy > 0;
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

void settle_camera(const RecordingOptions& options,
                   const Sidecar& sidecar,
                   const CameraFacts& facts,
                   RecordingInfo& info) {
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
    throw Error(info.path.string() + ": the recording does not say its camera intrinsics; " +
                kHowToGiveIntrinsics);
  }
  Intrinsics& k = info.intrinsics;
  if (!info.intrinsics_source.empty() && !usable(k)) {
    throw Error(info.path.string() + ": intrinsics fx " + std::to_string(k.fx) + ", fy " +
                std::to_string(k.fy) + " from " + info.intrinsics_source +
                " are not usable, expected focal lengths above 0 in pixels");
  }
  if (k.width > 0 && k.height > 0 && (k.width != info.width || k.height != info.height)) {
    throw Error(info.path.string() + ": depth images are " + size_text(info.width, info.height) +
                " but the intrinsics in " + info.intrinsics_source + " are for " +
                size_text(k.width, k.height));
  }
  k.width = info.width;
  k.height = info.height;
  // Of a cropped image it may be a little outside.
  if (std::abs(k.cx - 0.5 * k.width) > k.width || std::abs(k.cy - 0.5 * k.height) > k.height)
    throw Error(fmt::format(
        "{}: principal point cx {:g}, cy {:g} from {} is far outside the {} depth image",
        info.path.string(), k.cx, k.cy, info.intrinsics_source,
        size_text(info.width, info.height)));

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
    info.depth_unit_m = kRealSenseUnit_m;
    info.depth_unit_source = "assumed (RealSense default)";
  }
  if (!(info.depth_unit_m > 0) || !std::isfinite(info.depth_unit_m)) {
    throw Error(info.path.string() + ": depth unit " + std::to_string(info.depth_unit_m) +
                " m from " + info.depth_unit_source + ", expected metres per count above 0");
  }
}

bool set_distortion(const std::string& model,
                    const std::vector<double>& coefficients,
                    Intrinsics& intrinsics) {
  intrinsics.distortion = Distortion::none;
  intrinsics.coefficients = {};
  const bool all_zero =
      std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0; });
  if (all_zero) return true;
  const std::string lower = lower_case(model);
  const auto names = [&](const char* part) { return lower.find(part) != std::string::npos; };
  const bool finite = std::all_of(coefficients.begin(), coefficients.end(),
                                  [](double c) { return std::isfinite(c); });
  // More than five coefficients are a rational model, which ours cannot express.
  const bool five =
      coefficients.size() <= 5 ||
      std::all_of(coefficients.begin() + 5, coefficients.end(), [](double c) { return c == 0; });
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

}  // namespace planescope::io
