#pragma once

// The paper's symbols as it prints them: what follows an underscore stands lower and smaller,
// "N_out = 12" and "θ_Nout".

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

float math_width(const Ui& ui, const std::string& text);
/// At a place of the window.
void draw_math(const Ui& ui, ImDrawList* draw, ImVec2 at, ImU32 color, const std::string& text);
/// At the cursor; advances like text.
void math_text(const Ui& ui, ImU32 color, const std::string& text);

}  // namespace planescope::desktop
