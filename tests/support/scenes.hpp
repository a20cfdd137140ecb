#pragma once

// Random clouds with known structure, for tests and benchmarks.

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// Random measurements about each point: what voxels of a noisy cloud hold.
inline std::vector<Spread> random_spreads(std::size_t points, Random& random) {
  std::vector<Spread> spreads(points);
  const double scatter = random.uniform(0.0005, 0.004);
  for (Spread& s : spreads) {
    Mat3d covariance = Mat3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const Vec3d off = scatter * Vec3d(random.normal(), random.normal(), random.normal());
      covariance += off * off.transpose() / 4;
    }
    const Eigen::Matrix3f c = covariance.cast<float>();
    s = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  }
  return spreads;
}

struct CloudWithGaps {
  LabelledCloud cloud;
  Vec3d sensor;
  Measurements more;
};

/// Up to four rectangles and a few specks of one plane, level, tilted or upright, before a second
/// plane that has strips missing, so that some of the gaps between the rectangles are looked
/// through, some in part and some not at all. Every other cloud has rays; of these some have points
/// beyond; every third has spreads.
inline CloudWithGaps cloud_with_gaps(std::uint64_t seed) {
  Random random(seed);
  const int kind = random.integer(0, 2);  // level, tilted by up to 30 degrees, upright
  const Mat3d turn = (Eigen::AngleAxisd(kind == 1   ? random.uniform(0, 0.5)
                                        : kind == 2 ? -1.5707963
                                                    : 0,
                                        Vec3d::UnitY()) *
                      Eigen::AngleAxisd(random.uniform(0, 6.28), Vec3d::UnitZ()))
                         .toRotationMatrix();
  CloudWithGaps scene;
  scene.sensor = turn * Vec3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1.3);
  scene.more.rays = seed % 2 == 0;
  const double noise = random.uniform(0, 0.006);
  const Label label = kind == 2 ? Label::v : Label::h;
  const auto add = [&](double x, double y, double z, double beyond) {
    const Vec3d p = turn * Vec3d(x, y, z + noise * random.normal());
    if (p.cwiseAbs().maxCoeff() > 1.45) return;
    if (random.uniform() < beyond) {
      scene.more.beyond.push_back(p.cast<float>());
    } else {
      scene.cloud.points.push_back(p.cast<float>());
      scene.cloud.labels.push_back(label);
    }
  };
  const auto fill = [&](Vec2d low, Vec2d high, double spacing, double z, double beyond, auto keep) {
    for (double x = low.x(); x < high.x(); x += spacing)
      for (double y = low.y(); y < high.y(); y += spacing)
        if (keep(x))
          add(x + spacing * random.uniform(-0.3, 0.3), y + spacing * random.uniform(-0.3, 0.3), z,
              beyond);
  };
  const auto all = [](double) { return true; };

  const double spacing = random.uniform(0.02, 0.045);
  const bool alike = random.integer(0, 2) == 0;  // parts of equal size
  double x = -0.95;
  for (int part = random.integer(2, 4); part > 0 && x < 0.8; --part) {
    const double y = alike ? -0.2 : random.uniform(-0.5, 0.1);
    const Vec2d size(alike ? 0.3 : random.uniform(0.06, 0.5),
                     alike ? 0.4 : random.uniform(0.06, 0.5));
    fill({x, y}, Vec2d(x, y) + size, spacing, 0, 0, all);
    x += size.x() + random.uniform(0.03, 0.4);
  }
  for (int speck = random.integer(0, 4); speck > 0; --speck) {
    const Vec2d low(random.uniform(-0.95, 0.95), random.uniform(-0.5, 0.5));
    const Vec2d size(random.uniform(0.02, 0.12), random.uniform(0.02, 0.12));
    fill(low, low + size, 0.02, 0, 0, all);
  }
  double strips[4];
  for (double& strip : strips) strip = random.uniform(-1, 1);
  const double missing = random.uniform(0, 0.15);
  const double depth =
      random.uniform() < 0.3 ? random.uniform(0.02, 0.08) : random.uniform(0.1, 0.5);
  const double beyond = scene.more.rays && seed % 4 == 0 ? random.uniform() : 0;
  fill({-1.2, -0.7}, {1.2, 0.7}, random.uniform(0.03, 0.06), -depth, beyond, [&](double at) {
    return std::none_of(std::begin(strips), std::end(strips),
                        [&](double strip) { return std::abs(at - strip) < missing; });
  });
  scene.cloud.cube = cube_around(scene.cloud.points);
  if (seed % 3 == 0) scene.more.spreads = random_spreads(scene.cloud.points.size(), random);
  return scene;
}

}  // namespace planescope::test
