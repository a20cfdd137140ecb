#pragma once

// How the scene and the camera's image share the room that they have.

#include <cstdint>
#include <optional>

namespace planescope::desktop {

/// What shares the middle of the window.
enum class Views : std::uint8_t { both, scene, image };

struct Rect {
  float x = 0, y = 0, w = 0, h = 0;
};

struct Arrangement {
  std::optional<Rect> scene = {}, image = {};
  std::optional<Rect> between = {};  // the splitter, where there are both
  bool beside = false;               // or the scene above the image
};

/// `picture`: width of the image by its height, 0 where there is none: then the scene has it all.
/// Both stand side by side or one above the other, whichever shows them larger; the image has at
/// most `share` of the room and no more than its picture fills. `bar`: height of the tools above
/// each; `grip`: width of the splitter.
Arrangement arrange(
    const Rect& room, double picture, Views shown, double share, float bar, float grip);

}  // namespace planescope::desktop
