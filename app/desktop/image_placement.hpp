#pragma once

// The camera's image in its room on screen: zoomed, moved.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// Where the image lies on screen.
struct ImagePlacement {
  ImVec2 area_min, area_max;
  ImVec2 origin;    // of the image's upper left corner
  float scale = 1;  // screen pixels per image pixel
  int width = 0, height = 0;

  ImVec2 to_screen(float u, float v) const {
    return ImVec2(origin.x + scale * u, origin.y + scale * v);
  }
  ImVec2 to_image(ImVec2 at) const {
    return ImVec2((at.x - origin.x) / scale, (at.y - origin.y) / scale);
  }
  bool holds(ImVec2 uv) const {
    return uv.x >= 0 && uv.y >= 0 && uv.x < static_cast<float>(width) &&
           uv.y < static_cast<float>(height);
  }
};
/// An image of that size at the top left corner `at` of its room.
ImagePlacement place_image(const ViewState& view, ImVec2 at, ImVec2 room, int width, int height);
/// The part shown, so that image point `uv` comes to stand at `at`.
void show_image_part(const Ui& ui, const ImagePlacement& now, double zoom, ImVec2 uv, ImVec2 at);

}  // namespace planescope::desktop
