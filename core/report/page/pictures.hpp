#pragma once

// Pictures for pages: smaller copies, as what a page embeds, and maps of where planes are.

#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "core/report/compare/compare_reports.hpp"

namespace planescope::report {

/// The image shrunk to at most `max_width` pixels, each the mean of what it covers (never
/// enlarged).
Image8 shrink(const Image8& image, int max_width);

std::string base64(const std::vector<unsigned char>& bytes);

// Which plane is where in an image, drawn from the samples that a report keeps: available even
// where the pictures of an earlier run are gone.

/// How a plane stands out.
struct PlaneInk {
  std::string color = "#888888";  // "#rrggbb"
  bool marked = false;            // hatched and outlined strongly
};

/// RGBA: what was not measured is transparent, what is in no plane faint. `inks`: by plane id - 1.
/// Empty for clouds, whose samples are in no rows.
Image8 draw_plane_map(const RegionSample& sample, const std::vector<PlaneInk>& inks);

/// A plane that is in both has one colour in both, that of `colors_now`; lost and gained planes are
/// marked, lost ones in a dark grey.
struct ComparedInks {
  std::vector<PlaneInk> baseline, now;
};
ComparedInks compared_inks(const std::vector<PlaneComparison>& planes,
                           std::size_t planes_before,
                           const std::vector<std::string>& colors_now);

}  // namespace planescope::report
