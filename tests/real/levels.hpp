#pragma once

#include <string>
#include <vector>

#include "tests/real/frame_output.hpp"

namespace planescope {

/// Looks at the slice |y - `y_m`| < 3 cm of the output's cloud: each height of `levels_m` has a
/// horizontal plane within `tolerance_m`, and no horizontal plane spans two of them.
std::vector<std::string> check_levels(const FrameOutput& output,
                                      double y_m,
                                      const std::vector<double>& levels_m,
                                      double tolerance_m);

}  // namespace planescope
