#pragma once

#include <string>

#include "core/planes/result/analyze.hpp"

namespace planescope::report {

/// A picture of each plane, seen against its normal: what it covers, holes, what is unknown, where
/// a foot may go with its convex pieces, and the largest circle.
std::string planes_svg(const planes::FramePlanes& found);

}  // namespace planescope::report
