#include "core/planes/cloud/gravity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"
#include "core/planes/cloud/image_planes.hpp"

namespace planescope::planes {

GravityOptions parse_gravity(const std::string& text) {
  GravityOptions options;
  if (text == "auto") return options;
  if (text == "imu") {
    options.mode = GravityMode::imu;
    return options;
  }
  if (text == "estimate") {
    options.mode = GravityMode::estimate;
    return options;
  }
  if (text == "none") {
    options.mode = GravityMode::none;
    return options;
  }
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Vec3d direction;
  char comma1 = 0, comma2 = 0, rest = 0;
  in >> direction.x() >> comma1 >> direction.y() >> comma2 >> direction.z();
  if (in.fail() || comma1 != ',' || comma2 != ',' || in >> rest || !direction.allFinite() ||
      !(direction.norm() > 0))
    throw Error("gravity is \"" + text +
                "\", expected auto, imu, estimate, none or a direction X,Y,Z that is not zero");
  options.mode = GravityMode::fixed;
  options.direction = direction;
  return options;
}

Gravity unknown_gravity(const Frame& frame, const std::string& why) {
  Gravity gravity;
  gravity.direction = frame.is_cloud() ? Vec3d(-Vec3d::UnitZ()) : Vec3d(Vec3d::UnitY());
  gravity.source = GravitySource::none;
  gravity.confidence = 0;
  gravity.note = why;
  return gravity;
}

namespace {

constexpr double kFacing_deg = 15;    // between a plane that faces the camera and the optical axis
constexpr double kFacingShare = 0.5;  // of the measured pixels that such a plane covers
constexpr double kContraryShare = 0.1;  // of those that a plane of another direction covers at most

/// One plane that the camera looks at straight covers most of the image.
bool one_plane_faces_camera(const Frame& frame, std::size_t measured) {
  double facing = 0, contrary = 0;
  for (const ImagePlane& plane : find_image_planes(frame)) {
    const bool faces = std::abs(plane.normal.z()) > std::cos(kFacing_deg * std::numbers::pi / 180);
    (faces ? facing : contrary) += plane.pixels;
  }
  const auto all = static_cast<double>(measured);
  return facing > kFacingShare * all && contrary < kContraryShare * all;
}

struct WhyUnknown {
  std::string why;
  bool gravity_helps = true;  // to be given, or to be left open
};

/// Why a depth image says nothing about gravity.
WhyUnknown why_unknown(const Frame& frame, double max_range_m) {
  std::size_t measured = 0;
  std::uint16_t nearest = 65535, farthest = 0;
  for (const std::uint16_t count : frame.depth.data) {
    if (count == 0 || count == 65535) continue;
    ++measured;
    nearest = std::min(nearest, count);
    farthest = std::max(farthest, count);
  }
  if (measured == 0)
    return {fmt::format("holds no depth: all pixels are 0{}",
                        std::ranges::count(frame.depth.data, 65535) > 0 ? " or 65535" : ""),
            false};
  if (max_range_m > 0 && nearest * frame.depth_unit_m > max_range_m)
    return {fmt::format("all depths lie between {:.4g} and {:.4g} m, beyond --max-range {:.6g} m: "
                        "is --depth-unit {:.6g} right?",
                        nearest * frame.depth_unit_m, farthest * frame.depth_unit_m, max_range_m,
                        frame.depth_unit_m),
            false};
  if (one_plane_faces_camera(frame, measured))
    return {
        "one plane faces the camera: a wall straight ahead (--gravity 0,1,0), or a floor under a "
        "camera that looks down (--gravity 0,0,1)"};
  return {"gravity cannot be told from the scene"};
}

/// nullopt, with the reason, where nothing tells.
std::optional<Gravity> found_gravity(const Frame& frame,
                                     const GravityOptions& options,
                                     double max_range_m,
                                     WhyUnknown& why_not) {
  if (options.mode == GravityMode::imu) {
    if (frame.gravity && frame.gravity->source == GravitySource::imu) return frame.gravity;
    why_not.why = "the recording has no accelerometer data";
    return std::nullopt;
  }
  if (options.mode == GravityMode::automatic) {
    if (frame.gravity) return frame.gravity;
    if (frame.is_cloud())
      return Gravity{-Vec3d::UnitZ(), GravitySource::assumed, 1,
                     "assumed: the cloud's z axis points up"};
  }
  if (frame.is_cloud()) {
    why_not.why = "gravity is estimated from depth images only";
    return std::nullopt;
  }
  std::optional<Gravity> estimated = estimate_gravity(frame, options);
  if (!estimated) why_not = why_unknown(frame, max_range_m);
  return estimated;
}

}  // namespace

Gravity resolve_gravity(const Frame& frame, const GravityOptions& options, double max_range_m) {
  if (options.mode == GravityMode::none)
    return unknown_gravity(frame, "left open by --gravity none");
  if (options.mode == GravityMode::fixed) {
    Gravity gravity;
    // Scaled first: the squares of a tiny direction must not vanish.
    const Vec3d scaled = options.direction / options.direction.cwiseAbs().maxCoeff();
    if (!scaled.allFinite()) throw Error("gravity is not a direction: expected X,Y,Z not all zero");
    gravity.direction = scaled.normalized();
    gravity.source = GravitySource::option;
    gravity.note = "given by the user";
    return gravity;
  }
  WhyUnknown why_not;
  if (const auto found = found_gravity(frame, options, max_range_m, why_not)) return *found;
  if (options.none_where_unknown) return unknown_gravity(frame, why_not.why);
  std::string text = "frame " + frame.name + ": " + why_not.why;
  if (why_not.gravity_helps)
    text += std::string("; ") + kHowToGiveGravity +
            "; --gravity none finds planes without telling h from v";
  throw Error(text);
}

namespace {

// A wall that is less upright than this by what is known was meant for a floor, or what is known is
// too wrong to go by.
constexpr double kLeastUpright_deg = 30;
// Normals nearer to parallel than this magnify an error of theirs more than threefold.
constexpr double kLeastCorner_deg = 20;

double in_degrees(double radians) { return radians * 180 / std::numbers::pi; }

constexpr double kDoubt_deg = 20;
constexpr double kClearConfidence = 0.3;  // of an estimate that may cast doubt on what was given

std::string whole_degrees(double angle_deg) {
  return std::to_string(static_cast<int>(std::lround(angle_deg))) + "\u00b0";
}

std::optional<Vec3d> of_one_wall(const Vec3d& normal, const Vec3d& before, std::string& why_not) {
  const double upright_deg = in_degrees(std::acos(std::min(1.0, std::abs(normal.dot(before)))));
  if (upright_deg < kLeastUpright_deg) {
    why_not = "that surface lies level rather than upright, " + whole_degrees(upright_deg) +
              " from it: is it a floor?";
    return std::nullopt;
  }
  return Vec3d(before - before.dot(normal) * normal).normalized();
}

}  // namespace

std::string doubt_in_gravity(const Frame& frame,
                             const Vec3d& given,
                             const GravityOptions& options) {
  const Vec3d direction = given.normalized();
  const auto tilt_deg = [](const Vec3d& gravity) { return in_degrees(std::acos(gravity.y())); };
  if (frame.is_cloud() || tilt_deg(direction) > options.max_tilt_deg) return "";
  const auto seen = estimate_gravity(frame, options);
  if (!seen || seen->confidence < kClearConfidence) return "";
  const double off_deg =
      in_degrees(std::acos(std::clamp(direction.dot(seen->direction), -1.0, 1.0)));
  if (off_deg <= kDoubt_deg) return "";
  const Vec3d& d = seen->direction;
  return fmt::format(
      "gravity {:.3f},{:.3f},{:.3f} contradicts the scene by {}, which says {:.3f},{:.3f},{:.3f} "
      "({}, confidence {:.2f})",
      direction.x(), direction.y(), direction.z(), whole_degrees(off_deg), d.x(), d.y(), d.z(),
      seen->note, seen->confidence);
}

Vec3d gravity_of_floor(const Vec3d& normal) { return -normal.normalized(); }

std::optional<Vec3d> gravity_of_walls(std::span<const Vec3d> normals,
                                      const Vec3d& before,
                                      std::string* why_not) {
  std::string why;
  std::optional<Vec3d> direction;
  if (normals.size() == 1) {
    direction = of_one_wall(normals[0], before.normalized(), why);
  } else if (!normals.empty()) {
    double corner_deg = 0;  // the largest angle between two of them
    Mat3d squares = Mat3d::Zero();
    for (const Vec3d& a : normals) {
      squares += a * a.transpose();
      for (const Vec3d& b : normals)
        corner_deg = std::max(corner_deg, in_degrees(std::acos(std::min(1.0, std::abs(a.dot(b))))));
    }
    if (corner_deg < kLeastCorner_deg) {
      why = "the walls are parallel to " + whole_degrees(corner_deg) +
            ": click one that stands across";
    } else {
      const Vec3d across = eigen_symmetric(squares).vectors.col(0);
      direction = across.dot(before) < 0 ? Vec3d(-across) : across;
    }
  }
  if (!direction && why_not) *why_not = why;
  return direction;
}

}  // namespace planescope::planes
