#pragma once

// What lies over both views of the label mode: planes' names, the shape being drawn, what is under
// the mouse, what the wand found.

#include "app/desktop/labeling/label_pointer.hpp"

namespace planescope::desktop {

void draw_label_overlay(const Ui& ui, const DrawingSurface& surface);
/// A few words in a box with its upper left corner at `at`; returns its height.
float draw_badge(const Ui& ui, ImVec2 at, const std::string& text, ImU32 ground, ImU32 ink);

}  // namespace planescope::desktop
