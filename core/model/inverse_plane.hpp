#pragma once

// Planes seen along rays. On a plane n . X = d the inverse distance along a ray is linear in the
// ray, w = (n / d) . ray, and what stereo errs by is the same for w at any distance: least squares
// here weight near and far correctly (in metres the noise grows with the distance squared).

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/model/types.hpp"

namespace planescope {

struct InversePlane {
  Vec3d w_of_ray = Vec3d::Zero();  // n / d [1/m]
  double rms = 0;                  // of w [1/m]: a metre off at a distance r is 1 / r^2
  /// Towards the sensor: w > 0, so n . ray < 0.
  Vec3d normal() const { return -w_of_ray.normalized(); }
};

/// Sums for the least-squares fit; additive.
struct InverseSums {
  Mat3d rr = Mat3d::Zero();  // ray ray^T
  Vec3d rw = Vec3d::Zero();
  double ww = 0;
  int count = 0;

  void add(const Vec3d& ray, double w) {
    rr += ray * ray.transpose();
    rw += ray * w;
    ww += w * w;
    ++count;
  }
  InverseSums& operator+=(const InverseSums& other) {
    rr += other.rr;
    rw += other.rw;
    ww += other.ww;
    count += other.count;
    return *this;
  }
  InverseSums& operator-=(const InverseSums& other) {
    rr -= other.rr;
    rw -= other.rw;
    ww -= other.ww;
    count -= other.count;
    return *this;
  }
  InversePlane fit() const {
    InversePlane plane;
    plane.w_of_ray = rr.ldlt().solve(rw);
    const double squares = ww - plane.w_of_ray.dot(rw);
    plane.rms = std::sqrt(std::max(0.0, squares) / std::max(1, count - 3));
    return plane;
  }
  /// RMS of w about any plane [1/m].
  double rms_about(const Vec3d& w_of_ray) const {
    const double squares = ww - 2 * w_of_ray.dot(rw) + w_of_ray.dot(rr * w_of_ray);
    return std::sqrt(std::max(0.0, squares) / std::max(1, count));
  }
};

}  // namespace planescope
