#pragma once

// Pictures for pages: reduced copies, their encoding for embedding, and maps of planes.

#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "core/report/compare/compare_reports.hpp"

namespace planescope::report {

/// Shrinks the image to at most `max_width` pixels, each the mean of the covered pixels (never
/// enlarges).
Image8 shrink(const Image8& image, int max_width);

std::string base64(const std::vector<unsigned char>& bytes);

// A map of the planes in an image, drawn from the samples in a report: available even if the
// pictures of an earlier run are gone.

/// Style of a plane on the map.
struct PlaneInk {
  std::string color = "#888888";  // "#rrggbb"
  bool marked = false;            // hatched, with a strong outline
};

/// RGBA: unmeasured samples are transparent, samples outside planes faint. `inks`: by plane id - 1.
/// Empty for clouds, whose samples are not in rows.
Image8 draw_plane_map(const RegionSample& sample, const std::vector<PlaneInk>& inks);

/// A plane in both has the same color in both, from `colors_now`. Lost and gained planes are
/// marked, lost ones in dark gray.
struct ComparedInks {
  std::vector<PlaneInk> baseline, now;
};
ComparedInks compared_inks(const std::vector<PlaneComparison>& planes,
                           std::size_t planes_before,
                           const std::vector<std::string>& colors_now);

}  // namespace planescope::report
