#pragma once

// The colours of data, and those of everything else.

#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/octree.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// Colours that stay apart under the common colour-vision deficiencies (Okabe & Ito 2008), the same
/// in every picture, report and window.
Rgba case_color(planes::Case c);
Rgba label_color(Label label);  // h, v, unknown
/// From blue at -1, behind a plane, over near white on it to red at +1, before it.
Rgba residual_color(double share);
/// How sure a label is: from a dark grey that h and v share at margin 0 to the label's own colour
/// at 1, lighter and more saturated all the way.
Rgba margin_color(Label label, double margin);
Rgba leftover_color();
/// Whether a plane carries a foot.
Rgba verdict_color(bool steppable);
/// Colors of planes: few, so that any two differ clearly, also for color-blind readers, and so does
/// each from leftover_color(). plane_colors.hpp says which plane gets which.
inline constexpr int kPlaneColors = 14;
/// By color id, from 1 on; they repeat after kPlaneColors.
Rgba plane_color(int color_id);

/// A perceptually even ramp from dark at 0 to bright at 1, ordered for every eye.
Rgba ramp_color(double share);
Rgba depth_color(double depth_m, double max_m);  // the same, near is bright; 0 is neutral grey

/// The colours of everything that is not data.
struct ThemeColors {
  Rgba background_top, background_bottom;
  Rgba ink;                  // titles and text
  Rgba muted;                // subtitles, scale bar
  Rgba panel, panel_border;  // under overlay text
  Rgba halo;                 // around labels and arrows
  Rgba axis_x, axis_y, axis_z;
};
const ThemeColors& theme_colors(Theme theme);

}  // namespace planescope::render
