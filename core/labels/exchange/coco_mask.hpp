#pragma once

// Masks of the COCO format (https://cocodataset.org/#format-data): runs of 0 and 1 in turn, the
// pixels column by column.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace planescope::labels {

/// Consecutive pixels in column order u * height + v that are inside.
struct MaskRun {
  std::uint64_t first = 0, count = 0;
};

/// `sorted`: u * height + v, ascending, none twice.
std::vector<std::uint64_t> mask_counts(const std::vector<std::uint64_t>& sorted,
                                       std::uint64_t pixels);

/// Throws Error naming `where` unless the counts add up to `pixels`.
std::vector<MaskRun> mask_runs(const std::vector<std::uint64_t>& counts,
                               std::uint64_t pixels,
                               const std::string& where);
/// The counts of a mask that pycocotools compressed into text.
std::vector<std::uint64_t> counts_of_text(const std::string& text, const std::string& where);

/// Pixels whose centre is inside the polygon (even-odd); (0, 0) is the upper left pixel's corner.
std::vector<MaskRun> polygon_runs(const std::vector<std::pair<double, double>>& corners,
                                  int width,
                                  int height);

}  // namespace planescope::labels
