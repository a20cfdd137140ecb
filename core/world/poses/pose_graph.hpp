#pragma once

// Poses from motions between them that do not quite agree (Grisetti et al. 2010).

#include <vector>

#include "core/model/types.hpp"

namespace planescope::world {

using Mat6d = Eigen::Matrix<double, 6, 6>;

/// A measured motion: T_from_to takes points of `to` into `from`. Errors are a small turn about the
/// axes of `to` and a shift along them, rotation first.
struct PoseEdge {
  int from = 0, to = 0;
  Pose T_from_to = Pose::Identity();
  Mat6d information = Mat6d::Identity();
  bool loop = false;  // may be wrong: counts less the farther off it is (Cauchy)
};

/// Least squares over all edges by Gauss-Newton; the first pose stays. `T_world_pose`: where to
/// start. What no edge leads to stays as well.
void optimise_poses(std::vector<Pose>& T_world_pose, const std::vector<PoseEdge>& edges);

}  // namespace planescope::world
