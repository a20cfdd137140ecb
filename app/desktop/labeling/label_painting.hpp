#pragma once

// What the label mode's tools leave on the pixels that they took.

#include <span>
#include <string>

#include "app/desktop/actions/actions.hpp"

namespace planescope::desktop {

/// "P3", "ignore", "nothing", "h", "v".
std::string name_of_paint(const labels::Paint& paint);
/// What strokes leave, as it was chosen. For plane 0, the id that a new plane gets.
labels::Paint paint_in_hand(const State& state);
/// The pixels that a gesture would change.
StrokePreview preview_of(const State& state, labels::SpaceSelection taken, labels::PaintMode mode);
/// One undo step, its plane the active one from then on. Throws Error where nothing may be changed;
/// where nothing would be, it says so.
void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode);

}  // namespace planescope::desktop
