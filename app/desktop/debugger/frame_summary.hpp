#pragma once

// What of a frame is on planes, and why the rest is not.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

void draw_frame_summary(const Ui& ui, const RunView& view);

}  // namespace planescope::desktop
