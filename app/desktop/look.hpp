#pragma once

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// What the 3D view and the image draw. What is only selected because the cursor is on it is shown
/// as the cursor's, not as a choice of the user's.
render::StepLook look_of(const State& state);

}  // namespace planescope::desktop
