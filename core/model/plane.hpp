#pragma once

// Moments of points, least-squares planes, and polygons on a plane.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope {

// Sun et al. 2023, Sec. IV-D "Plane Merging": N, the sum of points and X X^T are additive, so
// merging two sets needs no access to the points.

/// Zeroth, first and second moments of a set of points relative to a fixed origin, in meters. Keep
/// the origin within a few meters of the points to avoid cancellation in the scatter.
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
  /// Eqs. (8)-(10): X1 X1^T <- X1 X1^T + X2 X2^T, and likewise mu and N.
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

/// The least-squares plane of a set of points: centroid, unit normal and the eigenvalues of the
/// scatter matrix (not divided by N; ascending; m^2). e_n of the paper is eigenvalues[0].
struct PlaneFit {
  double count = 0;
  Vec3d centroid = Vec3d::Zero();
  Vec3d normal = Vec3d::UnitZ();
  Vec3d eigenvalues = Vec3d::Zero();

  double rms_m() const;                                     // sqrt(e_n / N)
  double offset_m() const { return normal.dot(centroid); }  // normal . x = offset
  double distance_m(const Vec3d& p) const { return normal.dot(p - centroid); }  // signed
};

/// PCA of a set with at least 3 points (fewer: a fit with normal +z and zero eigenvalues). The
/// normal's sign is fixed: its largest component in absolute value is positive.
PlaneFit fit_plane(const Moments& moments);

/// Eigenvalues (ascending) and eigenvectors (columns, same order) of a symmetric 3x3 matrix by
/// cyclic Jacobi rotations, which are accurate for the tiny eigenvalues of nearly exact planes.
struct Eigen3 {
  Vec3d values;
  Mat3d vectors;
};
Eigen3 eigen_symmetric(const Mat3d& a);

/// Two unit vectors u, v with u x v = normal, determined by the normal alone.
struct PlaneBasis {
  Vec3d u;
  Vec3d v;
};
PlaneBasis plane_basis(const Vec3d& normal);

/// Convex hull, counter-clockwise, without collinear points. Returns the distinct points if there
/// are fewer than 3.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points);

/// Area of a simple polygon [m^2], positive if counter-clockwise.
double polygon_area(std::span<const Vec2d> polygon);

}  // namespace planescope

// Planes along rays. On a plane n . X = d the inverse distance along a ray is linear in the ray, w
// = (n / d) . ray, and stereo errors of w are independent of distance. Least squares in w therefore
// weights near and far points correctly (in meters the noise grows with the distance squared).

namespace planescope {

struct InversePlane {
  Vec3d w_of_ray = Vec3d::Zero();  // n / d [1/m]
  double rms = 0;                  // of w [1/m]: an error of 1 m at a distance r is 1 / r^2
  /// Toward the sensor: w > 0, so n . ray < 0.
  Vec3d normal() const { return -w_of_ray.normalized(); }
};

/// Sums for the least-squares fit; additive.
struct InverseSums {
  static constexpr int kSums = 10;  // sums of products: x, y, z and w, each with itself and the
                                    // ones after it
  int count = 0;

  InverseSums() = default;
  /// `sums` over `rays` rays; the last is w w.
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
  /// += more - less, in one pass.
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

 private:
  double sums_[kSums] = {};
};

}  // namespace planescope
