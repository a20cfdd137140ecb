#pragma once

// The motion between two depth frames. Internal to core/labels.

#include <functional>
#include <stop_token>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

struct Registration {
  Pose T_to_from = Pose::Identity();
  bool used_color = false;
  double fitness = 0;  // share of points with a partner
  double rms_m = 0;    // of partners, across the surface
};

/// Point-to-plane from coarse to fine, each point against what is seen where it falls in the other
/// image; where both frames have aligned colour, brightness counts as well. Starts from no motion.
/// Throws Cancelled when stopped. Sums run in one order: the same bits on every run.
Registration register_frames(const LabelGrid& from,
                             const LabelGrid& to,
                             std::stop_token stop,
                             const std::function<void(double)>& progress);

}  // namespace planescope::labels
