#pragma once

// What a click asks of the search for fixes.

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// Its surface is the label wand's. Some 50 ms for a depth image.
debug::FixTarget fix_target(const debug::Run& run, const PointAsked& asked);

}  // namespace planescope::desktop
