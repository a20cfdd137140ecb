#include "core/lab/experiments/cell_figures.hpp"

namespace planescope::lab {

std::optional<Cell> joined_cell(const PaperResults& results, std::span<const CellKey> keys) {
  if (keys.size() == 1) {  // to the same bits
    const Cell* cell = results.find(keys[0]);
    return cell ? std::optional(*cell) : std::nullopt;
  }
  std::vector<planes::Metrics> of_frames;
  Cell joined;
  planes::Metrics sums;
  for (const CellKey& key : keys) {
    const Cell* cell = results.find(key);
    if (!cell) return std::nullopt;
    of_frames.insert(of_frames.end(), static_cast<std::size_t>(cell->frames), cell->metrics);
    const std::vector<planes::Metrics> both = {sums, cell->metrics};
    sums = planes::mean_of(both);  // its counts are sums
    joined.frames += cell->frames;
  }
  joined.metrics = planes::mean_of(of_frames);
  for (const auto count : {&planes::Metrics::planes_truth, &planes::Metrics::planes_found,
                           &planes::Metrics::detected_iou80, &planes::Metrics::correct,
                           &planes::Metrics::over_segmented, &planes::Metrics::under_segmented,
                           &planes::Metrics::missed, &planes::Metrics::noise,
                           &planes::Metrics::pieces, &planes::Metrics::ghosts})
    joined.metrics.*count = sums.*count;
  joined.metrics.points = sums.points;
  joined.metrics.r_p = percent(sums.planes_found, sums.planes_truth);
  return joined;
}

}  // namespace planescope::lab
