#pragma once

#include <cmath>

namespace planescope::lab {

/// libm may differ in the last bit between machines, and so would the pixels that follow: rounded
/// to 2^-40 (1e-12) they are the same everywhere.
inline double repeatable(double x) { return std::round(x * 0x1p40) * 0x1p-40; }
inline double sin_deg(double degrees) { return repeatable(std::sin(degrees * M_PI / 180)); }
inline double cos_deg(double degrees) { return repeatable(std::cos(degrees * M_PI / 180)); }

}  // namespace planescope::lab
