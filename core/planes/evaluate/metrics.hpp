#pragma once

// A segmentation against the truth: which found plane stands for which true one, the paper's three
// metrics (Sec. V), and stricter ones (SegComp, EVOPS conventions) beside them.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

// ---- Matching ----

/// Points shared by each true and each found plane. Row 0 / column 0: in no plane.
struct TruthOverlap {
  int truth = 0, found = 0;  // largest ids
  std::vector<std::uint64_t> shared;
  std::vector<std::uint64_t> truth_size, found_size;

  std::uint64_t at(int t, int f) const {
    return shared[static_cast<std::size_t>(t) * (found + 1) + f];
  }
  double iou(int t, int f) const;
};

/// Ids: > 0 a plane, 0 none; truth < 0 is not counted. Planes up to the ids given have their places
/// even where they have no points.
TruthOverlap count_truth_overlap(std::span<const std::int32_t> truth,
                                 std::span<const std::int32_t> found,
                                 int last_truth = 0,
                                 int last_found = 0);

/// One to one, with the greatest sum of IoU: by true id - 1 the found id, 0 where it has none.
std::vector<int> found_of_truth(const TruthOverlap& overlap);

/// Planes of two segmentations that correspond.
struct PlanePair {
  int a = 0, b = 0;  // ids
  double iou = 0;
};
/// Each plane at most once, the pair of the greatest IoU first: what is the same plane in two runs,
/// where found_of_truth() is what stands for a true one.
std::vector<PlanePair> pairs_by_overlap(const TruthOverlap& overlap);

/// Hungarian method (Kuhn-Munkres with potentials, O(n^3)): the assignment of rows to columns with
/// the greatest total of `value` (row-major, rows x columns, values >= 0). Per row its column, -1
/// where the row got none or a pair of value 0.
std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns);

/// Between the unit normals of two planes, whichever way they look: 0 to 90 degrees.
double plane_angle_deg(const Vec3d& a, const Vec3d& b);

// ---- Labels ----

inline constexpr double kEdgeDistanceM = 0.02;  // "near an edge"

/// How many labels are right, counted separately for points within 2 cm of another true label and
/// for all others. Points of unknown truth do not count.
struct LabelAccuracy {
  std::uint64_t edge_right = 0, edge = 0;
  std::uint64_t inner_right = 0, inner = 0;

  double percent() const;  // of all; 100 where there are none, here and below
  double edge_percent() const;
  double inner_percent() const;
  LabelAccuracy& operator+=(const LabelAccuracy& other);
};

/// Which points lie within 2 cm of a reference point with another label than theirs: 1, else 0.
std::vector<std::uint8_t> near_other_label(std::span<const Vec3f> points,
                                           std::span<const Label> labels,
                                           std::span<const Vec3f> reference_points,
                                           std::span<const Label> reference_labels);

/// `near_edge` by near_other_label().
LabelAccuracy label_accuracy(std::span<const Label> truth,
                             std::span<const Label> found,
                             std::span<const std::uint8_t> near_edge);

/// A point is near an edge where the cloud says so, or else where it lies near a point of another
/// label.
LabelAccuracy label_accuracy(const LabelledCloud& cloud, std::span<const Label> found);

// ---- Metrics ----

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
