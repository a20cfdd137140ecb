#pragma once

// Labels points as horizontal (h) or vertical (v): the interface, and the PCA classifier.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

/// One value per point. Margin: 0 on the decision boundary, 1 certain.
struct Classification {
  std::vector<Label> labels;
  std::vector<float> margins;
};

/// Labels a batch of points. Re-entrant. The result is the same for any thread count and, up to the
/// order of the output, for any order of the points.
class Classifier {
 public:
  virtual ~Classifier() = default;
  virtual std::string name() const = 0;  // as passed to --classifier
  /// `points`: one cloud in the world frame (z up), in meters, relative to a local origin.
  virtual Classification classify(std::span<const Vec3f> points, int threads) const = 0;
};

/// Classifies a cloud at any position: subtracts its lower corner before calling `classifier`.
Classification classify_about_origin(const Classifier& classifier,
                                     std::span<const Vec3d> points,
                                     int threads);

struct PcaClassifierOptions {
  int neighbors = 16;         // points in each local fit, including the point itself
  double max_angle_deg = 45;  // Eq. (1): h up to pi/4 from gravity
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = PcaClassifierOptions;
    rows.number("pca_neighbours", "PCA neighbors", "points",
                "Points in each local plane fit, including the point itself", &O::neighbors,
                {3, 1000});
    rows.number("pca_max_angle_deg", "PCA angle limit", "deg",
                "Eq. (1): horizontal if the normal is within this angle of gravity",
                &O::max_angle_deg, {0, 90});
  }
};
std::unique_ptr<Classifier> make_pca_classifier(const PcaClassifierOptions& options = {});

/// Applies `classify` to the finite points only. Non-finite points get label `unknown` and margin
/// 0.
template <typename Classify>
Classification classify_finite(std::span<const Vec3f> points, const Classify& classify) {
  const auto finite = [](const Vec3f& p) { return p.allFinite(); };
  if (std::all_of(points.begin(), points.end(), finite)) return classify(points);
  std::vector<Vec3f> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept), finite);
  const Classification of_kept = classify(std::span<const Vec3f>(kept));
  Classification result;
  result.labels.assign(points.size(), Label::unknown);
  result.margins.assign(points.size(), 0.0f);
  for (std::size_t i = 0, k = 0; i < points.size(); ++i) {
    if (!finite(points[i])) continue;
    result.labels[i] = of_kept.labels[k];
    result.margins[i] = of_kept.margins[k++];
  }
  return result;
}

/// Points with true labels, for training and evaluating classifiers.
struct LabeledCloud {
  std::string kind;           // source: "stairs", "scan", ...
  std::vector<Vec3f> points;  // z up, meters, relative to a local origin
  std::vector<Label> labels;
  std::vector<std::uint8_t> near_edge = {};  // 1: within 2 cm of a surface or measured pixel with
                                             // the other label; empty if the surfaces are unknown
};

}  // namespace planescope::planes
