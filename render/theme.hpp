#pragma once

#include "render/draw_list.hpp"

namespace planescope::render {

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
