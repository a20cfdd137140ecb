#pragma once

// R10: marks planes that are not useful surfaces as minor: facets of curved things, strips along
// edges, sheets of flying pixels. A plane's pixels count the less the more ragged, curved and rough
// its picture is. Minor planes are listed apart, and their points are left over.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r10_minor {

struct Options {
  bool on = false;
  double pixels = 400;
  double ragged = 2;  // exponents
  double curved = 4;
  double rough = 1.5;
  double calm_m = 0.005;  // at 1 m; grows with range squared, as the error of stereo does

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r10_minor", "R10: depth images: list small, ragged and curved planes apart",
              &Options::on);
    rows.number("r10_pixels", "px",
                "R10: planes are minor whose pixels, in an image 640 pixels wide, count for less",
                &Options::pixels);
    rows.number("r10_ragged", "1",
                "R10: ragged pictures count less: exponent of the share of their convex hull",
                &Options::ragged);
    rows.number("r10_curved", "1",
                "R10: curved ones count less: exponent of the RMS about a quadric by that about "
                "the plane",
                &Options::curved);
    rows.number("r10_rough", "1", "R10: rough ones count less: exponent of r10_calm_m by their RMS",
                &Options::rough);
    rows.number("r10_calm_m", "m", "R10: RMS up to which no plane is rough, at 1 m",
                &Options::calm_m, {0, 1000, true});
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R10",
    .title = "minor planes",
    .says = "{plane} counts for {value:.0f} px, too few to be listed, its points are left over",
    .why_dropped =
        "a minor plane: small, ragged, curved or rough, it counts for {value:.0f} px, "
        "fewer than r10_pixels",
    .after = After::assignment,
    .turn = 6,
    .on_pixels = true};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r10_minor
