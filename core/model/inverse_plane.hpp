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
  static constexpr int kSums = 10;  // of the products of x, y, z and w with those from them on
  int count = 0;

  InverseSums() = default;
  /// `sums` of `count` rays, w w last.
  InverseSums(int rays, const double (&sums)[kSums]) : count(rays) {
    std::copy_n(sums, kSums, sums_);
  }

  void add(const Vec3d& ray, double w) {
    const double x = ray.x(), y = ray.y(), z = ray.z();
    const double products[kSums] = {x * x, x * y, x * z, y * y, y * z,
                                    z * z, x * w, y * w, z * w, w * w};
    for (int i = 0; i < kSums; ++i) sums_[i] += products[i];
    ++count;
  }
  InverseSums& operator+=(const InverseSums& other) {
    for (int i = 0; i < kSums; ++i) sums_[i] += other.sums_[i];
    count += other.count;
    return *this;
  }
  InverseSums& operator-=(const InverseSums& other) {
    for (int i = 0; i < kSums; ++i) sums_[i] -= other.sums_[i];
    count -= other.count;
    return *this;
  }
  /// += more - less, in one go.
  void add_difference(const InverseSums& more, const InverseSums& less) {
    for (int i = 0; i < kSums; ++i) sums_[i] += more.sums_[i] - less.sums_[i];
    count += more.count - less.count;
  }
  Mat3d rr() const {  // ray ray^T
    Mat3d rr;
    rr << sums_[0], sums_[1], sums_[2], sums_[1], sums_[3], sums_[4], sums_[2], sums_[4], sums_[5];
    return rr;
  }
  Vec3d rw() const { return {sums_[6], sums_[7], sums_[8]}; }  // ray w
  double ww() const { return sums_[9]; }

  InversePlane fit() const {
    InversePlane plane;
    plane.w_of_ray = rr().ldlt().solve(rw());
    const double squares = ww() - plane.w_of_ray.dot(rw());
    plane.rms = std::sqrt(std::max(0.0, squares) / std::max(1, count - 3));
    return plane;
  }
  /// RMS of w about any plane [1/m].
  double rms_about(const Vec3d& w_of_ray) const {
    const double squares = ww() - 2 * w_of_ray.dot(rw()) + w_of_ray.dot(rr() * w_of_ray);
    return std::sqrt(std::max(0.0, squares) / std::max(1, count));
  }

 private:
  double sums_[kSums] = {};
};

}  // namespace planescope
