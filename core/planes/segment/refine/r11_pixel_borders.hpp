#pragma once

// R11: pixels near a border are given to planes one by one. A voxel has one plane and covers many
// pixels, so that borders follow the voxel grid. A pixel may go to the planes in reach of it, to
// the one that the measurements around it lie on best.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r11_pixel_borders {

struct Options {
  bool on = false;
  double reach_m = 0.012;     // from a pixel to the nearest one that the plane has
  double taus = 1;            // and this near to it, in tau
  int window_px = 9;          // distances are averaged over so many pixels, against their noise
  double company_taus = 0.3;  // for a window all of whose pixels are on the plane already

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r11_pixel_borders",
              "R11: depth images: give pixels near borders to planes one by one", &Options::on);
    rows.number("r11_reach_m", "m", "R11: pixels this far from a plane's own may go to it",
                &Options::reach_m);
    rows.number("r11_taus", "tau", "R11: pixels this far off a plane do not go to it",
                &Options::taus);
    rows.number("r11_window_px", "px", "R11: distances to planes are averaged over so many pixels",
                &Options::window_px, {1, 63});
    rows.number("r11_company_taus", "tau",
                "R11: so much nearer counts a plane that has all pixels around",
                &Options::company_taus);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R11",
    .title = "pixel borders",
    .says = "most pixels of point {point} lie better on {other} than on {plane}",
    .after = After::assignment,
    .turn = 5,
    .on_pixels = true};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r11_pixel_borders
