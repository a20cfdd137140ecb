#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

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

}  // namespace planescope::planes
