#pragma once

// The pixels that an outline covers.

#include <optional>
#include <vector>

#include "core/planes/outline/outline.hpp"
#include "core/planes/outline/rings.hpp"

namespace planescope::planes {

/// Those whose centres are within, row by row; holes where nothing was measured as well where
/// `with_unknown`. Nothing where a corner is not ahead of the camera.
std::optional<std::vector<PixelRun>> pixels_within(const Outline& outline,
                                                   const Intrinsics& camera,
                                                   const Pose& T_sensor_world,
                                                   bool with_unknown);

}  // namespace planescope::planes
