#pragma once

// How high a plane's measurements are above it, place by place.

#include <span>
#include <vector>

#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

/// A grid on a plane, in the coordinates of its outline: in each cell the mean over the
/// measurements there.
class Places {
 public:
  struct Measured {
    Vec2d at;  // on the plane [m]
    double height_m = 0, weight = 0;
  };
  Places(std::span<const Measured> measured, double cell_m);

  double covered_m2() const { return occupied_ * cell_m_ * cell_m_; }
  /// RMS of how high cells are above the mean of those about them.
  double rough_rms_m() const;
  /// A percentile of the steps between cells side by side.
  double step_m(double share) const;
  /// What is within reach of cells that, in the mean with those about them, are farther than the
  /// limit from the plane: cells, and corners between them to 1.5 cells. Valid.
  Polygons near_off(double limit_m, double reach_m) const;
  /// Measured places along the line through `at` towards a unit vector, to half a cell: how far
  /// from `at`, and how high [m], in that order.
  std::vector<Vec2d> cut(const Vec2d& at, const Vec2d& towards) const;

 private:
  struct Cell {
    double sum = 0, weight = 0, height_m = 0;
  };
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * columns_ + x; }
  /// Over 5 cm to each side, about a foot: what is rough for it, a bow of a whole floor is not.
  double mean_about(int x, int y) const;

  Vec2d low_ = Vec2d::Zero();
  double cell_m_;
  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
  int occupied_ = 0;
  int about_ = 1;  // cells
};

/// One for each plane, by id - 1. `cell_m`: as wide as a voxel.
std::vector<Places> places_of(const FrameResult& result,
                              const std::vector<Outline>& outlines,
                              double cell_m);

}  // namespace planescope::planes
