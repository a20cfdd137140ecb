#include "app/desktop/image_placement.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace planescope::desktop {

ImagePlacement place_image(const ViewState& view, ImVec2 at, ImVec2 room, int width, int height) {
  ImagePlacement placed;
  placed.area_min = at;
  placed.area_max = ImVec2(at.x + room.x, at.y + room.y);
  placed.width = width;
  placed.height = height;
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  placed.scale = std::min(room.x / w, room.y / h) * static_cast<float>(view.image_zoom);
  // An image that is smaller than its room stands in the middle.
  const auto begin = [&](float room_px, float image_px, double center) {
    if (image_px <= room_px) return (room_px - image_px) / 2;
    return std::clamp(room_px / 2 - static_cast<float>(center) * image_px, room_px - image_px,
                      0.0f);
  };
  placed.origin = ImVec2(at.x + begin(room.x, placed.scale * w, view.image_center.x()),
                         at.y + begin(room.y, placed.scale * h, view.image_center.y()));
  return placed;
}

void show_image_part(const Ui& ui, const ImagePlacement& now, double zoom, ImVec2 uv, ImVec2 at) {
  zoom = std::clamp(zoom, 1.0, 64.0);
  const double scale = now.scale * zoom / ui.state.view.image_zoom;
  const double middle_x = (now.area_min.x + now.area_max.x) / 2;
  const double middle_y = (now.area_min.y + now.area_max.y) / 2;
  ui.emit("image.view",
          fmt::format("{:.6g},{:.6g},{:.6g}", zoom, (uv.x + (middle_x - at.x) / scale) / now.width,
                      (uv.y + (middle_y - at.y) / scale) / now.height));
}

}  // namespace planescope::desktop
