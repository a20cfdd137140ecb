#include "core/planes/cloud/gravity_pick.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/plane.hpp"

namespace planescope::planes {
namespace {

// A wall that is less upright than this by what is known was meant for a floor, or what is known is
// too wrong to go by.
constexpr double kLeastUpright_deg = 30;
// Normals nearer to parallel than this magnify an error of theirs more than threefold.
constexpr double kLeastCorner_deg = 20;

double in_degrees(double radians) { return radians * 180 / std::numbers::pi; }

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
