#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/classify/classifier.hpp"
#include "core/geometry/types.hpp"

namespace planescope {

/// How many labels are right, apart for points within 2 cm of a point with another true label and
/// for all others. Points of unknown truth do not count.
struct LabelAccuracy {
  std::uint64_t edge_right = 0, edge = 0;
  std::uint64_t inner_right = 0, inner = 0;

  double edge_percent() const;  // 100 where there are none
  double inner_percent() const;
  LabelAccuracy& operator+=(const LabelAccuracy& other);
};
LabelAccuracy label_accuracy(std::span<const Vec3f> points,
                             std::span<const Label> truth,
                             std::span<const Label> found);

}  // namespace planescope
