#pragma once

// Evaluates a segmentation against ground truth: matches found planes to true planes, and computes
// the paper's three metrics (Sec. V) and stricter ones (SegComp, EVOPS conventions).

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

// ---- Matching ----

/// Points shared by each true and each found plane. Row 0 / column 0: no plane.
struct TruthOverlap {
  int truth = 0, found = 0;  // largest ids
  std::vector<std::uint64_t> shared;
  std::vector<std::uint64_t> truth_size, found_size;

  std::uint64_t at(int t, int f) const {
    return shared[static_cast<std::size_t>(t) * (found + 1) + f];
  }
  double iou(int t, int f) const;
};

/// Ids: > 0 a plane, 0 none; truth < 0 is ignored. `last_truth` and `last_found` reserve entries
/// for planes without points.
TruthOverlap count_truth_overlap(std::span<const std::int32_t> truth,
                                 std::span<const std::int32_t> found,
                                 int last_truth = 0,
                                 int last_found = 0);

/// One-to-one matching with the largest sum of IoU: the found id by true id - 1, 0 if unmatched.
std::vector<int> found_of_truth(const TruthOverlap& overlap);

/// Corresponding planes of two segmentations.
struct PlanePair {
  int a = 0, b = 0;  // ids
  double iou = 0;
};
/// Greedy one-to-one matching in order of decreasing IoU, for the same plane in two runs. To match
/// found planes with true planes, use found_of_truth().
std::vector<PlanePair> pairs_by_overlap(const TruthOverlap& overlap);

/// Hungarian method (Kuhn-Munkres with potentials, O(n^3)): the assignment of rows to columns with
/// the largest total of `value` (row-major, rows x columns, values >= 0). Returns the column of
/// each row; -1 if unassigned or assigned with value 0.
std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns);

/// Angle between two planes, ignoring the sign of their unit normals: 0 to 90 degrees.
double plane_angle_deg(const Vec3d& a, const Vec3d& b);

// ---- Labels ----

inline constexpr double kEdgeDistanceM = 0.02;  // "near an edge"

/// Correctly labeled points, counted separately for points within 2 cm of another true label and
/// for all others. Points with unknown truth are ignored.
struct LabelAccuracy {
  std::uint64_t edge_right = 0, edge = 0;
  std::uint64_t inner_right = 0, inner = 0;

  double percent() const;  // of all points; each percentage is 100 if there are no points
  double edge_percent() const;
  double inner_percent() const;
  LabelAccuracy& operator+=(const LabelAccuracy& other);
};

/// 1 for points within 2 cm of a reference point with a different label, else 0.
std::vector<std::uint8_t> near_other_label(std::span<const Vec3f> points,
                                           std::span<const Label> labels,
                                           std::span<const Vec3f> reference_points,
                                           std::span<const Label> reference_labels);

/// `near_edge`: from near_other_label().
LabelAccuracy label_accuracy(std::span<const Label> truth,
                             std::span<const Label> found,
                             std::span<const std::uint8_t> near_edge);

/// Uses the cloud's own `near_edge`, or else the distance to points with a different label.
LabelAccuracy label_accuracy(const LabeledCloud& cloud, std::span<const Label> found);

// ---- Metrics ----

struct Metrics {
  int planes_truth = 0;
  int planes_found = 0;
  double alpha_deg = 0;       // mean angle of each found plane to its majority truth plane
  double r_p = 0;             // 100 x found / true
  double r_m = 0;             // % of points on true planes that are in no found plane
  double point_accuracy = 0;  // % of points whose plane is Hungarian-matched to the true plane
  double mean_iou = 0;        // % over true planes; unmatched planes count as 0
  double pq = 0;  // panoptic quality, %: sum of IoU > 0.5 / (number of such pairs + half of all
                  // other planes)
  int detected_iou80 = 0;  // matched with IoU >= 0.8
  int correct = 0;         // SegComp: the pair shares 80 % of the points of both planes
  int over_segmented = 0, under_segmented = 0, missed = 0, noise = 0;
  // Found planes that match no true plane with IoU > 0.5:
  int pieces = 0;  // at least half of its points on one true plane
  int ghosts = 0;  // all others
  // % of points within 2 cm of another label, and of the others. NaN if the truth or the result has
  // no labels (unknown gravity).
  double label_accuracy_edge = 0, label_accuracy_inner = 0;
  std::uint64_t points = 0;  // number of scored points
};

/// Ids: > 0 a plane, 0 none, truth < 0 not scored. Found planes with mostly unscored points are
/// ignored. A zero vector in `truth_normals` means unknown: alpha then uses a plane fitted to the
/// truth points.
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

/// EVOPS (Kornilova et al. 2022), %: share of found planes, and of true planes, that are correct. 0
/// if there are none.
double plane_precision(const Metrics& metrics);
double plane_recall(const Metrics& metrics);

/// Unweighted mean over frames (r_p: ratio of the sums; counts: sums; labels: mean over frames
/// with labels).
Metrics mean_of(std::span<const Metrics> metrics);

// Metrics by name, as used in all files and tables.

/// Whether the value was added in a later version: older files lack it, and read as 0.
inline bool is_late_value(std::string_view name) {
  return name == "correct" || name == "pieces" || name == "ghosts";
}

/// Calls visit(name, value) for each value; `metrics` may be const.
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
