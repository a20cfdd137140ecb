#pragma once

// Random clouds with known structure, for tests and benchmarks.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/model/random.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::test {

struct LabeledCloud {
  std::vector<Vec3f> points;
  std::vector<Label> labels;
  planes::Cube cube;
};

inline planes::Cube cube_around(const std::vector<Vec3f>& points) {
  Vec3f low = points[0], high = points[0];
  for (const Vec3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  planes::Cube cube;
  cube.min_corner = ((low + high) / 2).cast<double>() - Vec3d::Constant(cube.edge_m / 2);
  return cube;
}

/// Up to six rectangles, horizontal, vertical or tilted, with noise, clutter and some wrong labels.
inline LabeledCloud random_cloud(std::uint64_t seed) {
  Random random(seed);
  LabeledCloud cloud;
  const int faces = random.integer(1, 6);
  const double noise = random.uniform(0, 0.004), wrong = random.uniform(0, 0.05);
  const auto add = [&](const Vec3d& p, Label label) {
    cloud.points.push_back(p.cwiseMax(-1.45).cwiseMin(1.45).cast<float>());
    const bool flip = random.uniform() < wrong;
    cloud.labels.push_back(flip ? (label == Label::h ? Label::v : Label::h) : label);
  };
  for (int f = 0; f < faces; ++f) {
    const int kind = random.integer(0, 2);  // horizontal, vertical, tilted by up to 30 degrees
    const double tilt = kind == 0 ? 0 : kind == 1 ? 1.5707963 : random.uniform(0, 0.5);
    const Mat3d turn = (Eigen::AngleAxisd(random.uniform(0, 6.28), Vec3d::UnitZ()) *
                        Eigen::AngleAxisd(tilt, Vec3d::UnitY()))
                           .toRotationMatrix();
    const Vec3d center(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7),
                       random.uniform(-0.5, 0.5));
    const double a = random.uniform(0.1, 0.7), b = random.uniform(0.1, 0.7);
    const int n = random.integer(30, 700);
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform(-a, a), v = random.uniform(-b, b),
                   w = noise * random.normal();
      add(center + turn * Vec3d(u, v, w), tilt < 0.785 ? Label::h : Label::v);
    }
  }
  const int clutter = random.integer(0, 60);
  for (int i = 0; i < clutter; ++i) {
    const double x = random.uniform(-1.2, 1.2), y = random.uniform(-1.2, 1.2);
    const double z = random.uniform(-0.8, 0.8);
    add({x, y, z}, random.uniform() < 0.5 ? Label::h : Label::v);
  }
  cloud.cube = cube_around(cloud.points);
  return cloud;
}

/// Low and high steps: some have slanted faces with either label, some have faces as narrow as the
/// noise. Labels near edges are often wrong.
inline LabeledCloud random_steps(std::uint64_t seed) {
  Random random(seed);
  LabeledCloud cloud;
  const double noise = random.uniform(0, 0.006), wrong = random.uniform(0, 0.3);
  const double spacing = random.uniform(0.012, 0.025), width = random.uniform(0.1, 0.5);
  const Mat3d turn = Eigen::AngleAxisd(random.uniform(0, 6.28), Vec3d::UnitZ()).toRotationMatrix();
  Vec3d edge(-0.7, 0, -0.6);
  for (int face = random.integer(3, 9); face > 0; --face) {
    const int kind = random.integer(0, 4);  // 0: slanted, otherwise horizontal and vertical
    const double slope = kind == 0 ? random.uniform(0.4, 1.2) : kind % 2 == 0 ? 0 : 1.5707963;
    const bool is_h = kind == 0 ? random.uniform() < 0.5 : slope == 0;
    const double length =
        random.uniform() < 0.5 ? random.uniform(0.01, 0.1) : random.uniform(0.1, 0.35);
    const Vec3d along(std::cos(slope), 0, std::sin(slope)), normal(-along.z(), 0, along.x());
    for (double u = 0; u < length; u += spacing)
      for (double v = -width / 2; v < width / 2; v += spacing) {
        const Vec3d jitter{random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.normal()};
        const Vec3d p = edge + (u + spacing * jitter.x()) * along + noise * jitter.z() * normal +
                        (v + spacing * jitter.y()) * Vec3d::UnitY();
        const bool near_edge = std::min(u, length - u) < 0.02;
        const bool flip = random.uniform() < (near_edge ? wrong : wrong / 20);
        cloud.points.push_back((turn * p).cast<float>());
        cloud.labels.push_back(is_h != flip ? Label::h : Label::v);
      }
    edge += length * along;
  }
  cloud.cube = cube_around(cloud.points);
  return cloud;
}

}  // namespace planescope::test
