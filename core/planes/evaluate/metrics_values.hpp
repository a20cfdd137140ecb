#pragma once

// The values of Metrics by the names that every file and table gives them.

#include <string_view>

#include "core/planes/evaluate/metrics.hpp"

namespace planescope::planes {

/// Whether it came later than the rest: files of before lack it, and are read with 0 for it.
inline bool is_late_value(std::string_view name) {
  return name == "correct" || name == "pieces" || name == "ghosts";
}

/// visit(name, value) for each value; `metrics` may be const.
template <typename AnyMetrics, typename Visit>
void visit_values(AnyMetrics& metrics, Visit&& visit) {
  visit("planes_truth", metrics.planes_truth);
  visit("planes_found", metrics.planes_found);
  visit("alpha_deg", metrics.alpha_deg);
  visit("r_p", metrics.r_p);
  visit("r_m", metrics.r_m);
  visit("point_accuracy", metrics.point_accuracy);
  visit("mean_iou", metrics.mean_iou);
  visit("pq", metrics.pq);
  visit("detected_iou80", metrics.detected_iou80);
  visit("correct", metrics.correct);
  visit("over_segmented", metrics.over_segmented);
  visit("under_segmented", metrics.under_segmented);
  visit("missed", metrics.missed);
  visit("noise", metrics.noise);
  visit("pieces", metrics.pieces);
  visit("ghosts", metrics.ghosts);
  visit("label_accuracy_edge", metrics.label_accuracy_edge);
  visit("label_accuracy_inner", metrics.label_accuracy_inner);
  visit("points", metrics.points);
}

}  // namespace planescope::planes
