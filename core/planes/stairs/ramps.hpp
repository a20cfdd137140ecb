#pragma once

// Planes that lead from one level to another. Internal to core/planes/stairs.

#include <optional>
#include <span>

#include "core/planes/stairs/levels.hpp"

namespace planescope::planes {

/// A tilted plane as a ramp; nothing where neither of its ends meets a level of that height.
std::optional<SlopingPlane> ramp_of(const LevelPiece& piece,
                                    std::span<const Level> levels,
                                    const StairsOptions& options);

}  // namespace planescope::planes
