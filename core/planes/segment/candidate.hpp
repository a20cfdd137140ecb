#pragma once

// A plane candidate: one label's points of a node, and what is asked of it before it may join or
// found a plane. The traversal and whoever explains it call the same functions.

#include <cstdint>

#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/noise.hpp"

namespace planescope::planes {

/// A node's inliers (or, by R4, one label's points of an impure node).
struct Candidate {
  std::int32_t node = -1;
  Label label = Label::h;
  Moments moments;
  PlaneFit fit;
  double sigma_ang = 0;  // [rad]
  Bounds bounds;
};

/// PCA of the points of one label in a node, of all where labels are not used. Sums run over the
/// node's own range of points. Leaves sigma_ang open.
Candidate fit_label(const Octree& octree, std::int32_t node, Label label, bool use_labels);

/// Criterion 3 with the threshold in force: of e_n, or of the RMS [m] where the options ask so.
struct Planarity {
  double value = 0;
  double threshold = 0;
  bool passes = false;
};
Planarity planarity(const PlaneFit& fit,
                    const NoiseModel& noise,
                    double range_m,
                    const SegmentOptions& options);

}  // namespace planescope::planes
