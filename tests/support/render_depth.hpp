#pragma once

// A small analytic renderer for tests: parallelograms seen by a stereo camera with known gravity.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::test {

struct Parallelogram {
  Vec3d corner, u, v;  // world frame, z up [m]
};

/// Adds an axis-aligned box, rotated by `yaw` about the vertical through its corner's foot.
inline void add_box(std::vector<Parallelogram>& scene,
                    const Vec3d& corner,
                    const Vec3d& size,
                    double yaw = 0) {
  const Vec3d x(size.x() * std::cos(yaw), size.x() * std::sin(yaw), 0);
  const Vec3d y(-size.y() * std::sin(yaw), size.y() * std::cos(yaw), 0);
  const Vec3d z(0, 0, size.z());
  scene.push_back({corner + z, x, y});
  scene.push_back({corner, x, z});
  scene.push_back({corner, y, z});
  scene.push_back({corner + x, y, z});
  scene.push_back({corner + y, x, z});
}

struct Camera {
  double height_m = 0.8;
  double pitch_deg = 30;  // down
  double roll_deg = 0;
  double noise_px = 0.06;  // of disparity, correlated over a few pixels; 0 = exact depth
  std::uint64_t seed = 1;
};

inline Pose T_world_camera(const Camera& camera) {
  const double p = camera.pitch_deg * std::numbers::pi / 180;
  const double r = camera.roll_deg * std::numbers::pi / 180;
  Mat3d level;  // camera axes x right, y down, z forward, as columns in the world (x forward, z up)
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Pose pose = Pose::Identity();
  pose.linear() = level * Eigen::AngleAxisd(-p, Vec3d::UnitX()).toRotationMatrix() *
                  Eigen::AngleAxisd(r, Vec3d::UnitZ()).toRotationMatrix();
  pose.translation() = Vec3d(0, 0, camera.height_m);
  return pose;
}

inline Vec3d true_gravity(const Camera& camera) {
  return T_world_camera(camera).linear().transpose() * Vec3d(0, 0, -1);
}

inline Frame render_depth(const std::vector<Parallelogram>& scene, const Camera& camera) {
  constexpr double kFocal_px = 385, kBaseline_m = 0.05, kFarthest_m = 8;
  Frame frame;
  frame.name = "synthetic";
  frame.depth = Image16(640, 480);
  frame.depth_unit_m = 0.001;
  frame.intrinsics.width = 640;
  frame.intrinsics.height = 480;
  frame.intrinsics.fx = frame.intrinsics.fy = kFocal_px;
  frame.intrinsics.cx = 320;
  frame.intrinsics.cy = 240;
  const Pose pose = T_world_camera(camera);
  std::mt19937_64 random(camera.seed);
  std::normal_distribution<double> gauss(0, 1);
  // Noise on a coarse lattice, interpolated: correlated like that of a block matcher.
  constexpr int kStep = 5;
  const int across = 640 / kStep + 2, down = 480 / kStep + 2;
  std::vector<double> lattice(static_cast<std::size_t>(across) * down);
  for (double& value : lattice) value = gauss(random) * camera.noise_px;
  const auto noise = [&](int x, int y) {
    const int i = x / kStep, j = y / kStep;
    const double s = (x % kStep) / double{kStep}, t = (y % kStep) / double{kStep};
    const double* row = lattice.data() + static_cast<std::size_t>(j) * across + i;
    return (1 - t) * ((1 - s) * row[0] + s * row[1]) +
           t * ((1 - s) * row[across] + s * row[across + 1]);
  };
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) {
      const Vec3d ray = pose.linear() * Vec3d((x - 320) / kFocal_px, (y - 240) / kFocal_px, 1);
      double z = std::numeric_limits<double>::infinity();
      for (const Parallelogram& q : scene) {
        const Vec3d normal = q.u.cross(q.v);
        const double t = normal.dot(q.corner - pose.translation()) / normal.dot(ray);
        if (!(t > 0.1) || t >= z) continue;
        const Vec3d offset = pose.translation() + t * ray - q.corner;
        const double a = offset.cross(q.v).dot(normal) / normal.squaredNorm();
        const double b = q.u.cross(offset).dot(normal) / normal.squaredNorm();
        if (a >= 0 && a <= 1 && b >= 0 && b <= 1) z = t;
      }
      if (z > kFarthest_m) continue;
      const double disparity = kFocal_px * kBaseline_m / z + noise(x, y);
      if (disparity <= 0) continue;
      const double measured = kFocal_px * kBaseline_m / disparity;
      frame.depth.at(x, y) = static_cast<std::uint16_t>(
          std::lround(std::clamp(measured / frame.depth_unit_m, 0.0, 65535.0)));
    }
  return frame;
}

inline double angle_between_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180 /
         std::numbers::pi;
}

}  // namespace planescope::test
