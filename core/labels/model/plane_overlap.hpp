#pragma once

// How two labelings of the same pixels share them. Internal to core/labels.

#include <cstdint>
#include <span>
#include <vector>

namespace planescope::labels {

struct PlaneOverlap {
  std::vector<int> ids_a, ids_b;           // of planes with pixels that are scored, ascending
  std::vector<double> pixels_a, pixels_b;  // of each
  std::vector<double> shared;              // row-major, a x b
  std::size_t pixels = 0;                  // scored

  double at(std::size_t a, std::size_t b) const { return shared[a * ids_b.size() + b]; }
  double iou(std::size_t a, std::size_t b) const {
    return at(a, b) / (pixels_a[a] + pixels_b[b] - at(a, b));
  }
};

/// Ids > 0 are planes, 0 is none; where either is negative a pixel is not scored.
PlaneOverlap overlap_of(std::span<const std::int32_t> a, std::span<const std::int32_t> b);

/// Planes matched one to one for the greatest total of IoUs; of pairs with at least `least_iou`.
struct PlanePair {
  std::size_t a = 0, b = 0;  // places in the overlap's lists
};
std::vector<PlanePair> matched_planes(const PlaneOverlap& overlap, double least_iou);

}  // namespace planescope::labels
