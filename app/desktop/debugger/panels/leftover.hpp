#pragma once

// The part of the inspector that tells of a leftover point.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// Its distance to the planes that were considered at the step, and why it joined one or none.
/// Draws nothing where the step is no such event.
void draw_leftover(const Ui& ui, const debug::Run& run, std::int32_t step);

}  // namespace planescope::desktop
