#pragma once

// Gestures of the label mode, and the pixels that they mean. As text: "VIEW [MODE] [RADIUS] X,Y X,Y
// ...". VIEW is "image", whose pixels are the depth image's, or "space:WxH", a view of that size
// through the camera in force. MODE is over, add or subtract; over where it is left out. RADIUS is
// a brush's.

#include <optional>
#include <string>

#include "app/desktop/actions/actions.hpp"

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
/// With that many places or more.
Takes<LabelGesture> gesture(std::string shown, std::size_t least_places);
/// One place, in a view or, as "U,V", on the image.
Takes<LabelGesture> place_in_view(std::string shown);

/// Throws Error in a cloud, which has none to draw on.
void expect_image(const State& state);

/// The pixel that its first place means; -1 where nothing is seen there. Throws Error outside of
/// the image.
std::int64_t pixel_of_gesture(State& state, const std::string& action, const LabelGesture& where);
/// The wand's, within its limits; a plane that it shows grows anew.
void set_wand_tolerance(State& state, double wanted_m);

/// What a stroke (where a radius is given) or a closed path takes.
labels::SpaceSelection selected_by(State& state, const LabelGesture& gesture);

/// On which side of a line on the view each pixel's point lies, as split_by_side() takes it.
std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to);

}  // namespace planescope::desktop
