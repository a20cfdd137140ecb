#pragma once

// A label view in which tools work: mouse handling and overlays (plane names, the shape being
// drawn, the item under the mouse, the wand's result).

#include <functional>
#include <optional>
#include <string>

#include "app/desktop/labeling/work.hpp"
#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// Position and scale of a view in which tools work.
struct DrawingSurface {
  DrawnIn where = DrawnIn::image;
  int width = 0, height = 0;  // of the 3D view
  ImVec2 min, max;            // area on screen
  ImVec2 origin;              // screen position of the view's origin ...
  float scale = 1;            // ... and screen pixels per view pixel
  std::function<std::optional<ImVec2>(std::uint32_t)> screen_of_pixel;  // nullopt if not visible

  labels::Vec2f to_view(ImVec2 at) const {
    return {(at.x - origin.x) / scale, (at.y - origin.y) / scale};
  }
  ImVec2 to_screen(const labels::Vec2f& place) const {
    return ImVec2(origin.x + scale * place.x(), origin.y + scale * place.y());
  }
};

/// Tracks the mouse over the last drawn item and applies the current tool.
void use_label_tool(const Ui& ui, const DrawingSurface& surface);
/// Changes the current tool's size with the wheel over the last drawn item. Returns true if it did;
/// the wheel then must not zoom.
bool wheel_sizes(const Ui& ui);
/// Whether the left button pans the view, because the current tool does not use drags.
bool left_button_moves(const Ui& ui);

void draw_label_overlay(const Ui& ui, const DrawingSurface& surface);
/// Draws a short text in a box with its upper left corner at `at`; returns its height.
float draw_badge(const Ui& ui, ImVec2 at, const std::string& text, ImU32 ground, ImU32 ink);

}  // namespace planescope::desktop
