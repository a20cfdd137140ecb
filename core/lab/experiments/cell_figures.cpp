#include "core/lab/experiments/cell_figures.hpp"

namespace planescope {

std::optional<Cell> joined_cell(const PaperResults& results, std::span<const CellKey> keys) {
  if (keys.size() == 1) {  // to the same bits
    const Cell* cell = results.find(keys[0]);
    return cell ? std::optional(*cell) : std::nullopt;
  }
  std::vector<Metrics> of_frames;
  Cell joined;
  Metrics sums;
  for (const CellKey& key : keys) {
    const Cell* cell = results.find(key);
    if (!cell) return std::nullopt;
    of_frames.insert(of_frames.end(), static_cast<std::size_t>(cell->frames), cell->metrics);
    const std::vector<Metrics> both = {sums, cell->metrics};
    sums = mean_of(both);  // its counts are sums
    joined.frames += cell->frames;
  }
  joined.metrics = mean_of(of_frames);
  for (const auto count : {&Metrics::planes_truth, &Metrics::planes_found, &Metrics::detected_iou80,
                           &Metrics::correct, &Metrics::over_segmented, &Metrics::under_segmented,
                           &Metrics::missed, &Metrics::noise, &Metrics::pieces, &Metrics::ghosts})
    joined.metrics.*count = sums.*count;
  joined.metrics.points = sums.points;
  joined.metrics.r_p = percent(sums.planes_found, sums.planes_truth);
  return joined;
}

}  // namespace planescope
