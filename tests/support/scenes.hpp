#pragma once

// Random clouds with known structure, for tests and benchmarks.

#include <vector>

#include "core/base/random.hpp"
#include "core/segment/segment.hpp"

namespace planescope::test {

struct LabelledCloud {
  std::vector<Vec3f> points;
  std::vector<Label> labels;
  Cube cube;
};

inline Cube cube_around(const std::vector<Vec3f>& points) {
  Vec3f low = points[0], high = points[0];
  for (const Vec3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Cube cube;
  cube.min_corner = ((low + high) / 2).cast<double>() - Vec3d::Constant(cube.edge_m / 2);
  return cube;
}

/// Up to six rectangles, level, upright or tilted, with noise, clutter and some wrong labels.
inline LabelledCloud random_cloud(std::uint64_t seed) {
  Random random(seed);
  LabelledCloud cloud;
  const int faces = random.integer(1, 6);
  const double noise = random.uniform(0, 0.004), wrong = random.uniform(0, 0.05);
  const auto add = [&](const Vec3d& p, Label label) {
    cloud.points.push_back(p.cwiseMax(-1.45).cwiseMin(1.45).cast<float>());
    const bool flip = random.uniform() < wrong;
    cloud.labels.push_back(flip ? (label == Label::h ? Label::v : Label::h) : label);
  };
  for (int f = 0; f < faces; ++f) {
    const int kind = random.integer(0, 2);  // level, upright, tilted by up to 30 degrees
    const double tilt = kind == 0 ? 0 : kind == 1 ? 1.5707963 : random.uniform(0, 0.5);
    const Mat3d turn = (Eigen::AngleAxisd(random.uniform(0, 6.28), Vec3d::UnitZ()) *
                        Eigen::AngleAxisd(tilt, Vec3d::UnitY()))
                           .toRotationMatrix();
    const Vec3d centre(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7),
                       random.uniform(-0.5, 0.5));
    const double a = random.uniform(0.1, 0.7), b = random.uniform(0.1, 0.7);
    const int n = random.integer(30, 700);
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform(-a, a), v = random.uniform(-b, b),
                   w = noise * random.normal();
      add(centre + turn * Vec3d(u, v, w), tilt < 0.785 ? Label::h : Label::v);
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

}  // namespace planescope::test
