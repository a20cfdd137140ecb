#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry/types.hpp"

namespace planescope {

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

/// The k exact nearest neighbours of every point among all points, itself included: [n * k] indices
/// row by row, nearest first; kNoNeighbour at the end of each row where n < k. Equal distances are
/// ordered by coordinates (then index), so that rows hold the same coordinates for any order of the
/// points. The same for any thread count. Points must be finite.
std::vector<std::uint32_t> nearest_neighbours(std::span<const Vec3f> points, int k, int threads);

}  // namespace planescope
