#pragma once

// The paper's pointwise classification: a 3D-GCN (Lin et al., CVPR 2020) that labels each point.

#include <memory>
#include <span>
#include <vector>

#include "core/model/parallel.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::planes {

/// A network ready to run. Immutable, re-entrant.
class Gcn {
 public:
  explicit Gcn(const NetworkWeights& weights, Simd simd = best_simd());
  ~Gcn();

  /// Returns logits [n x 2], h then v, for finite points in any order. Bit-identical for any thread
  /// count and instruction set; permuting the points permutes the rows.
  std::vector<float> forward(std::span<const Vec3f> points, int threads) const;

 private:
  struct Layers;
  std::unique_ptr<const Layers> layers_;
};

/// Labels each point by its larger logit, with margin |p(h) - p(v)|. Non-finite points are
/// `unknown` and ignored. `name`: as passed to --classifier.
std::unique_ptr<Classifier> make_gcn_classifier(const NetworkWeights& weights,
                                                const std::string& name = "gcn",
                                                Simd simd = best_simd());

}  // namespace planescope::planes
