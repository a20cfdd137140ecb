#pragma once

// The paper's three metrics (Sec. V) and stricter ones (SegComp, EVOPS conventions) beside them.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

struct Metrics {
  int planes_truth = 0;
  int planes_found = 0;
  double alpha_deg = 0;       // mean angle of each found plane to its majority truth plane
  double r_p = 0;             // 100 x found / true
  double r_m = 0;             // % of points (that have a true plane) in no plane
  double point_accuracy = 0;  // % of points whose plane is Hungarian-matched to the true one
  double mean_iou = 0;        // % over true planes, unmatched count 0
  double pq = 0;  // panoptic quality, %: sum of IoU > 0.5 / (those + half of all other planes)
  int detected_iou80 = 0;  // matched with IoU >= 0.8
  int correct = 0;         // SegComp: share 80 % of a true and of a found plane's points
  int over_segmented = 0, under_segmented = 0, missed = 0, noise = 0;
  // Found planes that match no true one with IoU > 0.5 ...
  int pieces = 0;  // at least half of each lies on one true plane
  int ghosts = 0;  // all others
  // %, < 2 cm from another label or not; NaN where the truth has no
  // labels, or the result: gravity is not known
  double label_accuracy_edge = 0, label_accuracy_inner = 0;
  std::uint64_t points = 0;  // points scored
};

/// Ids: > 0 a plane, 0 none, truth < 0 not scored. A found plane most of whose points are not
/// scored is taken for none. Truth normals per truth id (index id - 1) may be zero vectors where
/// unknown: alpha then uses a plane fitted to the truth points.
struct MetricsInput {
  std::span<const Vec3f> points;
  std::span<const std::int32_t> truth;
  std::span<const std::int32_t> found;
  std::span<const Vec3d> found_normals;  // by found id - 1
  std::span<const Vec3d> truth_normals;  // by truth id - 1, or empty
  std::span<const Label> truth_labels;   // per point, or empty
  std::span<const Label> found_labels;   // per point, or empty
  int min_truth_points = 1;              // points of smaller true planes are not scored
};
Metrics evaluate(const MetricsInput& input);

/// EVOPS (Kornilova et al. 2022), %: of the planes that were found, and of the true ones, those
/// that are correct. 0 where there are none.
double plane_precision(const Metrics& metrics);
double plane_recall(const Metrics& metrics);

/// Unweighted mean over frames (r_p: ratio of the sums; counts: sums; labels: over frames with
/// some).
Metrics mean_of(std::span<const Metrics> metrics);

// The values of Metrics by the names that every file and table gives them.

/// Whether it was added later: older files lack it, and are read with 0 for it.
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
