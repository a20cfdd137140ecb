#pragma once

// Gestures of the label mode, and the pixels that they mean. As text: "VIEW [MODE] [RADIUS] X,Y X,Y
// ...". VIEW is "image", whose pixels are the depth image's, or "space:WxH", a view of that size
// through the camera in force. MODE is over, add or subtract; over where it is left out. RADIUS is
// a brush's.

#include <optional>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// Whether the frame is ready to be labelled and its labels are loaded.
bool labels_at_hand(const State& state);

struct LabelGesture {
  DrawnIn where = DrawnIn::image;
  int width = 0, height = 0;  // of the view in space
  labels::PaintMode mode = labels::PaintMode::over;
  std::optional<float> radius_px;
  std::vector<labels::Vec2f> path;
};
/// Throws Error naming the action where it is none, or has fewer places than that.
LabelGesture gesture_argument(const std::string& action,
                              const std::string& text,
                              std::size_t least_places);
std::string gesture_text(const LabelGesture& gesture);

/// Throws Error in a cloud, which has none to draw on.
void expect_image(const State& state);

/// "U,V", or "VIEW X,Y": the pixel meant; -1 where nothing is seen there.
std::int64_t pixel_argument(State& state, const std::string& action, const std::string& text);

/// What a stroke (where a radius is given) or a closed path takes.
labels::SpaceSelection selected_by(State& state, const LabelGesture& gesture);

/// On which side of a line on the view each pixel's point lies, as split_by_side() takes it.
std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to);

}  // namespace planescope::desktop
