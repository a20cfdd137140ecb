#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::lab {

/// Farthest point sampling: indices of `count` points (all, where there are fewer), each the one
/// farthest from those before it, beginning with point 0; of equally far ones the first.
std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count);

}  // namespace planescope::lab
