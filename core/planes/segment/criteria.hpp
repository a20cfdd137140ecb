#pragma once

// Sun et al. 2023, Sec. IV-B and IV-C: Criteria 1-4 as pure functions, shared by the traversal and
// by explanations.

#include <cstdint>

#include "core/model/plane.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::planes {

/// Counts that determine a node's purity. Inliers have the majority label; ties go to h. If labels
/// are not used, all points have `one_label`.
struct Purity {
  Label inlier = Label::h;
  std::uint32_t n_in = 0;
  std::uint32_t n_out = 0;
  double r_out() const {
    return n_in + n_out > 0 ? static_cast<double>(n_out) / (n_in + n_out) : 0;
  }
};
Purity purity_of(const OctreeNode& node, bool use_labels, Label one_label = Label::h);

/// Criterion 1 (purity), Eq. (2).
bool is_pure(const Purity& purity, const SegmentOptions& options);
/// Criterion 2 (minimum inlier points), Eq. (3).
bool has_enough_inliers(std::uint32_t n_in, const SegmentOptions& options);

/// e_n of Criterion 3 with the requested normalization.
double normal_error(const PlaneFit& fit, MseNormalization normalization);
/// Criterion 3 (plane candidate), Eq. (5) with <= as in the text: e_n <= theta_e_n.
bool is_planar(const PlaneFit& fit, double theta_e_n, MseNormalization normalization);

/// Criterion 4 (coplanarity), Eq. (6): its three terms, and the offset term added by
/// `paper-closest`.
struct Coplanarity {
  double normals = 0;  // |n1 . n2|
  double n1_dmu = 0;   // |n1 . (mu1 - mu2)| / |mu1 - mu2|, 0 if the centroids coincide
  double n2_dmu = 0;
  double offset_m = 0;  // |n1 . (mu1 - mu2)|
};
Coplanarity coplanarity(const PlaneFit& plane, const PlaneFit& candidate);
bool is_coplanar(const Coplanarity& terms, const SegmentOptions& options);

/// Area per point of a rectangle with the fit's second moments [m^2]; measures the point density.
double area_per_point(const PlaneFit& fit);

/// Terms of a pair relative to their limits; values up to 1 pass.
struct PairRatios {
  double angle = 0;     // between the normals
  double distance = 0;  // sine of the angle between the plane and the direction to the
                        // other centroid
  double worst = 0;     // maximum of all terms
};
PairRatios ratios_of(const Coplanarity& terms, const SegmentOptions& options);

/// A plane candidate: the inliers of a node or, with the objective, the points of one label in an
/// impure node.
struct Candidate {
  std::int32_t node = -1;
  Label label = Label::h;
  Moments moments;
  PlaneFit fit;
};

/// PCA of the points of one label in a node; of all points if labels are not used. Sums run over
/// the node's own range of points.
Candidate fit_label(const Octree& octree, std::int32_t node, Label label, bool use_labels);

/// Criterion 3 with the effective threshold: on e_n or, with the objective, on the RMS [m].
struct Planarity {
  double value = 0;
  double threshold = 0;
  bool passes = false;
};
Planarity planarity(const PlaneFit& fit, const NoiseModel& noise, const SegmentOptions& options);

}  // namespace planescope::planes
