#include "app/desktop/arrange.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::desktop {
namespace {

/// Of a picture that fits into the room below its tools.
float area_of(const Rect& room, float picture, float bar) {
  const float width = std::max(0.0F, std::min(room.w, (room.h - bar) * picture));
  return width * width / picture;
}

Arrangement side_by_side(const Rect& room, float picture, float share, float bar, float grip) {
  const float most = std::max(room.h - bar, 0.0F) * picture + bar / 2;
  const float image = std::round(std::min(share * room.w, most));
  const float scene = room.w - image - grip;
  return {.scene = Rect{room.x, room.y, scene, room.h},
          .image = Rect{room.x + room.w - image, room.y, image, room.h},
          .between = Rect{room.x + scene, room.y, grip, room.h},
          .beside = true};
}

Arrangement stacked(const Rect& room, float picture, float share, float bar, float grip) {
  const float most = room.w / picture + 1.5F * bar;
  const float image = std::round(std::min(share * room.h, most));
  const float scene = room.h - image - grip;
  return {.scene = Rect{room.x, room.y, room.w, scene},
          .image = Rect{room.x, room.y + room.h - image, room.w, image},
          .between = Rect{room.x, room.y + scene, room.w, grip}};
}

}  // namespace

Arrangement arrange(
    const Rect& room, double picture, Views shown, double share, float bar, float grip) {
  if (picture <= 0 || shown == Views::scene) return {.scene = room};
  if (shown == Views::image) return {.image = room};
  const auto of_image = static_cast<float>(picture), part = static_cast<float>(share);
  constexpr float kOfScene = 4.0F / 3;
  const auto worth = [&](const Arrangement& views) {
    return area_of(*views.scene, kOfScene, bar) * area_of(*views.image, of_image, bar);
  };
  const Arrangement a = side_by_side(room, of_image, part, bar, grip);
  const Arrangement b = stacked(room, of_image, part, bar, grip);
  return worth(b) > worth(a) ? b : a;
}

}  // namespace planescope::desktop
