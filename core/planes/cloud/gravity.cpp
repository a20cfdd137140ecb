#include "core/planes/cloud/gravity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"

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

/// nullopt, with a phrase why, where nothing tells.
std::optional<Gravity> found_gravity(const Frame& frame,
                                     const GravityOptions& options,
                                     std::string& why_not) {
  if (options.mode == GravityMode::imu) {
    if (frame.gravity && frame.gravity->source == GravitySource::imu) return frame.gravity;
    why_not = "the recording has no accelerometer data";
    return std::nullopt;
  }
  if (options.mode == GravityMode::automatic) {
    if (frame.gravity) return frame.gravity;
    if (frame.is_cloud())
      return Gravity{-Vec3d::UnitZ(), GravitySource::assumed, 1,
                     "assumed: the cloud's z axis points up"};
  }
  why_not = frame.is_cloud() ? "gravity is estimated from depth images only"
                             : "gravity cannot be told from the scene";
  return frame.is_cloud() ? std::nullopt : estimate_gravity(frame, options);
}

}  // namespace

Gravity resolve_gravity(const Frame& frame, const GravityOptions& options) {
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
  std::string why_not;
  if (const auto found = found_gravity(frame, options, why_not)) return *found;
  if (options.none_where_unknown) return unknown_gravity(frame, why_not);
  throw Error("frame " + frame.name + ": " + why_not + "; " + kHowToGiveGravity +
              "; --gravity none finds planes without telling h from v");
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
