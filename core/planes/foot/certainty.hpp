#pragma once

// How well a plane is known.

#include <vector>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// A true plane is taken to be normal + a axes[0] + b axes[1], and d along the normal from the
/// centroid: these three are independent of each other.
struct Certainty {
  double sigma_m = 0;                    // of the measurements about the plane
  Vec3d eigenvalues_m2 = Vec3d::Zero();  // of the scatter, ascending; the first is the paper's e_n
  Vec3d axes[2] = {Vec3d::UnitX(), Vec3d::UnitY()};  // unit, in the plane: the longer extent first
  double sigma_tilt_rad[2] = {0, 0};                 // of a and b
  double sigma_offset_m = 0;                         // of d

  /// Of (a, b, offset), where the plane is normal . x = offset and its centroid is `centroid`.
  Mat3d covariance(const Vec3d& centroid) const;
};

/// One for each plane, by id - 1.
std::vector<Certainty> certainties_of(const FrameResult& result);

}  // namespace planescope::planes
