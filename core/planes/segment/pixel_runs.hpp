#pragma once

// The depth image in runs along its rows: neighbouring pixels mostly went into the same point, and
// neighbouring points are mostly on the same plane, so that what holds for a run is asked once for
// all of its pixels.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/runs.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

/// Pixels side by side in a row that went into one point; up to where the next run begins.
struct MeasuredRun {
  std::uint32_t begin = 0;                    // pixel, in raster order
  std::uint32_t point = PixelGrid::kNoPoint;  // its Morton position
  bool is_measured() const { return point != PixelGrid::kNoPoint; }
};

/// All runs of the image, and one of no pixels at its end. `order`: which of segment()'s points is
/// at each Morton position.
std::vector<MeasuredRun> make_pixel_runs(const PixelGrid& pixels,
                                         std::span<const std::uint32_t> order);

/// Calls visit(plane, y, x_begin, x_end) for pixels side by side in a row that are on one plane, in
/// raster order. `planes`: per pixel, -1 none.
template <typename Visit>
void visit_plane_runs(const PixelGrid& pixels,
                      std::span<const std::int32_t> planes,
                      const Visit& visit) {
  for (int y = 0; y < pixels.height; ++y) {
    const auto row = planes.subspan(pixels.at(0, y), pixels.width);
    for (int x = 0; x < pixels.width;) {
      const int begin = x;
      x = static_cast<int>(end_of_run(row, begin));
      if (row[begin] >= 0) visit(row[begin], y, begin, x);
    }
  }
}

/// The runs of each plane, in raster order.
struct PlaneRuns {
  struct Run {
    std::uint32_t begin = 0, end = 0;  // pixels
  };
  std::vector<std::uint32_t> first;  // CSR
  std::vector<Run> runs;
  std::span<const Run> of(std::size_t plane) const {
    return {runs.data() + first[plane], runs.data() + first[plane + 1]};
  }
};
PlaneRuns runs_by_plane(const PixelGrid& pixels,
                        std::span<const std::int32_t> planes,
                        std::size_t plane_count);

}  // namespace planescope::planes
