#pragma once

// How two labelings of the same pixels share them, and how far they agree.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::labels {

/// What labels are compared with, on the same pixels.
struct OtherLabels {
  std::vector<std::int32_t> plane;  // per pixel, 0 none, -1 knows nothing here (cropped, ignored)
  std::vector<Label> label;         // of a plane, by id - 1
};
OtherLabels other_of(const FrameLabels& labels);

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

/// Agreement of two labelings of the same pixels.
struct Agreement {
  double mean_iou = 0;         // of planes matched one to one, over all planes of both
  double adjusted_rand = 0;    // over pixels that both label with a plane
  double label_accuracy = 0;   // same h/v, of pixels where both have one
  double pixel_agreement = 0;  // of labelled by either: same matched plane
  int planes_a = 0, planes_b = 0, matched = 0;  // matched: IoU of at least 0.5
  std::size_t pixels = 0;                       // scored: ignored by neither
};
Agreement agreement_of(const FrameLabels& a, const FrameLabels& b);

}  // namespace planescope::labels
