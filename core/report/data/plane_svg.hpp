#pragma once

#include <string>

#include "core/report/data/frame_planes.hpp"

namespace planescope::report {

/// A picture of each plane, seen against its normal: what it covers, holes, what is unknown, where
/// a foot may go with its convex pieces, and the largest circle.
std::string planes_svg(const FramePlanes& found);

}  // namespace planescope::report
