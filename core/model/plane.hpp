#pragma once

#include "core/model/moments.hpp"
#include "core/model/types.hpp"

namespace planescope {

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
/// cyclic Jacobi rotations: accurate for the tiny eigenvalues of nearly exact planes.
struct Eigen3 {
  Vec3d values;
  Mat3d vectors;
};
Eigen3 eigen_symmetric(const Mat3d& a);

}  // namespace planescope
