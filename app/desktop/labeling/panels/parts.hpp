#pragma once

// What the label mode's side panels share.

#include <string>

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// The labels of the frame looked at; where there are none yet, says why in their place.
std::shared_ptr<const FrameLabels> labels_to_show(const Ui& ui);
/// Facts of these labels, which must be those of the frame shown.
const LabelFacts& facts_of(const Ui& ui, const std::shared_ptr<const FrameLabels>& labels);

/// A small square in the plane's colour, and its name beside it. Dimmed where it is hidden.
void plane_swatch(const Ui& ui, int plane, bool dimmed = false);
std::string tilt_text(const LabelPlane& plane, const FrameLabels& labels);
std::string tilt_text(double tilt_deg);  // NaN: gravity is not known

/// A bar as wide as the panel with its text beside it: on it, the bar's end would hide it.
void share_bar(double share, const std::string& text);

enum class PlaneIcon : std::uint8_t { lock, eye };
/// A button with a drawn sign; true where it was clicked.
bool icon_button(const Ui& ui, PlaneIcon icon, bool on, const std::string& widget);

}  // namespace planescope::desktop
