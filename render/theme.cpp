#include "render/theme.hpp"

namespace planescope::render {

const ThemeColors& theme_colors(Theme theme) {
  static const ThemeColors light = {
      .background_top = {252, 252, 253},
      .background_bottom = {234, 237, 241},
      .ink = {28, 32, 38},
      .muted = {92, 99, 110},
      .panel = {255, 255, 255, 225},
      .panel_border = {28, 32, 38, 34},
      .halo = {255, 255, 255, 235},
      .axis_x = {213, 94, 0},
      .axis_y = {0, 140, 102},
      .axis_z = {0, 114, 178},
  };
  static const ThemeColors dark = {
      .background_top = {30, 33, 38},
      .background_bottom = {17, 19, 22},
      .ink = {233, 236, 240},
      .muted = {156, 163, 173},
      .panel = {24, 27, 31, 225},
      .panel_border = {255, 255, 255, 34},
      .halo = {12, 13, 15, 235},
      .axis_x = {240, 128, 48},
      .axis_y = {32, 186, 142},
      .axis_z = {86, 180, 233},
  };
  return theme == Theme::light ? light : dark;
}

}  // namespace planescope::render
