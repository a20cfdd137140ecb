#pragma once

// The mouse in either view of the label mode: points, draws with the tool in hand, sizes it.

#include <functional>
#include <optional>
#include <string>

#include "app/desktop/labeling/label_gesture.hpp"
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

/// Of the item drawn last.
void use_label_tool(const Ui& ui, const DrawingSurface& surface);
/// The wheel sizes what is in hand, and does so now: it does not zoom.
bool wheel_sizes(const Ui& ui);
/// The left button moves the view, as the tool in hand draws nothing with it.
bool left_button_moves(const State& state);

}  // namespace planescope::desktop
