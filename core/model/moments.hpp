#pragma once

// Sun et al. 2023, Sec. IV-D "Plane Merging": N, sum of points and X X^T, which add when two sets
// of points are joined, so that a merge never touches the points again.

#include "core/model/types.hpp"

namespace planescope {

/// Covariance of the measurements that a point is the mean of, upper triangle [m^2].
struct Spread {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// Zeroth, first and second moments of a set of points about a fixed origin (the frame's own:
/// metres; keep it within a few metres of the points, or the scatter cancels).
struct Moments {
  double count = 0;
  Vec3d sum = Vec3d::Zero();      // [m]
  double xx = 0, xy = 0, xz = 0;  // X X^T, upper triangle [m^2]
  double yy = 0, yz = 0, zz = 0;

  void add(const Vec3d& p) {
    count += 1;
    sum += p;
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    xz += p.x() * p.z();
    yy += p.y() * p.y();
    yz += p.y() * p.z();
    zz += p.z() * p.z();
  }
  /// A point that stands for many: the second moments of one point drawn at random from them.
  void add(const Vec3d& p, const Spread& spread) {
    add(p);
    xx += spread.xx;
    xy += spread.xy;
    xz += spread.xz;
    yy += spread.yy;
    yz += spread.yz;
    zz += spread.zz;
  }
  /// Eq. (8)-(10): X1 X1^T <- X1 X1^T + X2 X2^T, mu and N likewise.
  Moments& operator+=(const Moments& other) {
    count += other.count;
    sum += other.sum;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
    return *this;
  }
  Vec3d mean() const { return sum / count; }
  /// Eq. (11): (X - mu 1)(X - mu 1)^T = X X^T - N mu mu^T. Not divided by N, as in the paper.
  Mat3d scatter() const {
    const Vec3d mu = mean();
    Mat3d s;
    s << xx - mu.x() * sum.x(), xy - mu.x() * sum.y(), xz - mu.x() * sum.z(),  //
        0, yy - mu.y() * sum.y(), yz - mu.y() * sum.z(),                       //
        0, 0, zz - mu.z() * sum.z();
    s(1, 0) = s(0, 1);
    s(2, 0) = s(0, 2);
    s(2, 1) = s(1, 2);
    return s;
  }
};

}  // namespace planescope
