#pragma once

// Clouds of planes that lie in parts, before a second plane that shows in some of the gaps: what
// SplitRule::seen is for.

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/scenes.hpp"

namespace planescope::test {

struct CloudWithGaps {
  LabelledCloud cloud;
  Vec3d sensor;
  planes::Measurements more;
};

/// Random measurements about each point, as the voxels of a noisy cloud hold them.
inline std::vector<Spread> random_spreads(std::size_t points, Random& random) {
  std::vector<Spread> spreads(points);
  const double scatter = random.uniform(0.0005, 0.004);
  for (Spread& s : spreads) {
    Mat3d covariance = Mat3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const Vec3d off{random.normal(), random.normal(), random.normal()};
      covariance += scatter * scatter / 4 * off * off.transpose();
    }
    const Eigen::Matrix3f c = covariance.cast<float>();
    s = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  }
  return spreads;
}

/// Puts points on planes z = const of a frame that is level, tilted or upright.
class GapSceneMaker {
 public:
  explicit GapSceneMaker(std::uint64_t seed) : random_(seed) {
    const int kind = random_.integer(0, 2);
    const double spin = random_.uniform(0, 6.28), tilt = random_.uniform(0, 0.5);
    turn_ = Eigen::AngleAxisd(kind == 0   ? 0
                              : kind == 1 ? tilt
                                          : -1.5707963,
                              Vec3d::UnitY()) *
            Eigen::AngleAxisd(spin, Vec3d::UnitZ());
    label_ = kind == 2 ? Label::v : Label::h;
    noise_ = random_.uniform(0, 0.006);
    scale_ = random_.integer(0, 2) == 0 ? 0.45 : 1;  // small scenes are dense
    const Vec3d sensor{random_.uniform(-0.6, 0.6), random_.uniform(-0.6, 0.6), 1.3};
    scene_.sensor = turn_ * sensor;
  }

  CloudWithGaps make(bool rays, bool beyond, bool spreads) {
    scene_.more.rays = rays;
    const bool rows = random_.integer(0, 7) == 0;
    if (rows) {
      add_rows();
    } else {
      add_rectangles();
      add_specks();
    }
    add_background(beyond ? random_.uniform() : 0);
    scene_.cloud.cube = cube_around(scene_.cloud.points);
    if (spreads) scene_.more.spreads = random_spreads(scene_.cloud.points.size(), random_);
    return scene_;
  }

 private:
  /// A jittered lattice over a rectangle at this height; of its points, the share `beyond` is
  /// measured but no part of the cloud.
  void fill(
      const Vec2d& low, const Vec2d& size, double spacing, double height = 0, double beyond = 0) {
    for (double x = 0; x < size.x(); x += spacing)
      for (double y = 0; y < size.y(); y += spacing) {
        const Vec3d jitter{0.3 * spacing * random_.uniform(-1, 1),
                           0.3 * spacing * random_.uniform(-1, 1), noise_ * random_.normal()};
        const Vec3d p = turn_ * (Vec3d(low.x() + x, low.y() + y, height) + jitter);
        if (p.cwiseAbs().maxCoeff() > 1.45) continue;
        if (random_.uniform() < beyond) {
          scene_.more.beyond.push_back(p.cast<float>());
        } else {
          scene_.cloud.points.push_back(p.cast<float>());
          scene_.cloud.labels.push_back(label_);
        }
      }
  }

  void add_rectangles() {
    const double spacing = scale_ * random_.uniform(0.02, 0.045);
    const bool alike = random_.integer(0, 2) == 0;  // of equal size
    double x = -0.95;
    for (int part = random_.integer(2, 4); part > 0 && x < 0.8; --part) {
      Vec2d low{x, random_.uniform(-0.5, 0.1)};
      Vec2d size{random_.uniform(0.06, 0.5), random_.uniform(0.06, 0.5)};
      if (alike) low.y() = -0.2, size = {0.3, 0.4};
      fill(scale_ * low, scale_ * size, spacing);
      x += size.x() + (0.02 + 0.4 * std::pow(random_.uniform(), 2)) / scale_;
    }
  }

  /// Rows between small squares: they have more points, but no normal.
  void add_rows() {
    const double spacing = random_.uniform(0.012, 0.03);
    double x = -0.4;
    for (int part = random_.integer(2, 4); part > 0; --part) {
      const bool row = part % 2 == 1;
      const Vec2d size = row ? Vec2d(spacing / 2, 0.5) : Vec2d(0.1, 0.1);
      fill({x, -size.y() / 2}, size, spacing);
      x += size.x() + random_.uniform(0.05, 0.12);
    }
  }

  void add_specks() {
    for (int speck = random_.integer(0, 4); speck > 0; --speck) {
      const Vec2d low{random_.uniform(-0.95, 0.95), random_.uniform(-0.5, 0.5)};
      const Vec2d size{random_.uniform(0.02, 0.12), random_.uniform(0.02, 0.12)};
      fill(scale_ * low, scale_ * size, 0.02);
    }
  }

  /// In bands of many widths, so that gaps are looked through, some in part and some not at all.
  void add_background(double beyond) {
    const double spacing = scale_ * random_.uniform(0.03, 0.06);
    const bool near = random_.uniform() < 0.3;
    const double depth = near ? random_.uniform(0.02, 0.08) : random_.uniform(0.1, 0.5);
    for (double x = -1.2; x < 1.2;) {
      const double width = random_.uniform(0.1, 0.8);
      fill(scale_ * Vec2d(x, -0.7), scale_ * Vec2d(width, 1.4), spacing, -depth, beyond);
      x += width + random_.uniform(0, 0.3);
    }
  }

  Random random_;
  Mat3d turn_;
  Label label_ = Label::h;
  double noise_ = 0;  // [m]
  double scale_ = 1;
  CloudWithGaps scene_;
};

/// Every other cloud has rays, and of these every other points beyond; every third has spreads.
inline CloudWithGaps cloud_with_gaps(std::uint64_t seed) {
  return GapSceneMaker(seed).make(seed % 2 == 0, seed % 4 == 0, seed % 3 == 0);
}

}  // namespace planescope::test
