#pragma once

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// ImGui's style and colours for a theme, in one size of everything.
void set_style(render::Theme theme, float scale);
UiColors ui_colors(render::Theme theme);

}  // namespace planescope::desktop
