#pragma once

// Shared by the side panels of label mode.

#include <string>

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// Returns the labels of the current frame; if there are none yet, draws the reason instead.
std::shared_ptr<const FrameLabels> labels_to_show(const Ui& ui);
/// Facts about these labels, which must belong to the current frame.
const LabelFacts& facts_of(const Ui& ui, const std::shared_ptr<const FrameLabels>& labels);

/// Draws a small square in the plane's color with its name. Dimmed if the plane is hidden.
void plane_swatch(const Ui& ui, int plane, bool dimmed = false);
std::string tilt_text(const LabelPlane& plane, const FrameLabels& labels);
std::string tilt_text(double tilt_deg);  // NaN: gravity is unknown

/// A bar as wide as the panel, with its text beside it, where the bar cannot hide it.
void share_bar(double share, const std::string& text);

enum class PlaneIcon : std::uint8_t { lock, eye };
/// A button with an icon; returns true if clicked.
bool icon_button(const Ui& ui, PlaneIcon icon, bool on, const std::string& widget);

}  // namespace planescope::desktop
