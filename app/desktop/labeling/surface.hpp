#pragma once

// A view of the label mode in which tools work: what the mouse does there, and what lies over the
// view: planes' names, the shape being drawn, what is under the mouse, what the wand found.

#include <functional>
#include <optional>
#include <string>

#include "app/desktop/labeling/work.hpp"
#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// A view that tools work in, as it lies on screen.
struct DrawingSurface {
  DrawnIn where = DrawnIn::image;
  int width = 0, height = 0;  // of the view in space
  ImVec2 min, max;            // of the room
  ImVec2 origin;              // of the view's places ...
  float scale = 1;            // ... and their size on screen
  std::function<std::optional<ImVec2>(std::uint32_t)> screen_of_pixel;  // where it can be seen

  labels::Vec2f to_view(ImVec2 at) const {
    return {(at.x - origin.x) / scale, (at.y - origin.y) / scale};
  }
  ImVec2 to_screen(const labels::Vec2f& place) const {
    return ImVec2(origin.x + scale * place.x(), origin.y + scale * place.y());
  }
};

/// Follows the mouse over the ImGui item drawn last, and draws with the tool in hand.
void use_label_tool(const Ui& ui, const DrawingSurface& surface);
/// Sizes the tool in hand by the wheel, over the item drawn last. True where it did: then the wheel
/// does not zoom.
bool wheel_sizes(const Ui& ui);
/// Whether the left button moves the view: the tool in hand does not drag.
bool left_button_moves(const Ui& ui);

void draw_label_overlay(const Ui& ui, const DrawingSurface& surface);
/// A few words in a box with its upper left corner at `at`; returns its height.
float draw_badge(const Ui& ui, ImVec2 at, const std::string& text, ImU32 ground, ImU32 ink);

}  // namespace planescope::desktop
