#pragma once

// What was looked through: between two boxes of one height the floor was seen.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/planes/segment/state.hpp"

namespace planescope::planes {

/// Where the sensor's rays passed through a plane, within the bounds of its points.
class Sight {
 public:
  /// `spacing_m`: of the points.
  Sight(const SegmentState& state, std::int32_t plane, double spacing_m);
  /// Did rays pass through most of the gap between two parts of the plane, where they are nearest?
  /// A gap that something hides is not open, nor one without measurements.
  bool is_open_between(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) const;

 private:
  Vec2d on_plane(const Vec3d& p) const { return {u_.dot(p), v_.dot(p)}; }
  std::optional<Vec3d> passed_at(const Vec3d& measured) const;
  void mark(const Vec3d& measured);
  bool is_open_at(const Vec3d& p) const;

  const SegmentState& state_;
  const split_disconnected::Options& options_;
  const PlaneFit& fit_;
  Vec3d u_, v_;  // axes on the plane
  Vec2d low_;    // corner of the grid on it
  double cell_m_ = 0;
  int columns_ = 0, rows_ = 0;        // along u and v
  std::vector<std::uint8_t> passed_;  // per cell: rays did
};

}  // namespace planescope::planes
