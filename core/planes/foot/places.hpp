#pragma once

// Height map of the measurements on a plane.

#include <span>
#include <vector>

#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

/// A grid in the plane coordinates of an outline. Each cell contains the mean height of the
/// measurements in it.
class Places {
 public:
  struct Measured {
    Vec2d at;  // in plane coordinates [m]
    double height_m = 0, weight = 0;
  };
  Places(std::span<const Measured> measured, double cell_m);

  double covered_m2() const { return occupied_ * cell_m_ * cell_m_; }
  /// RMS height of cells above the mean of the surrounding cells.
  double rough_rms_m() const;
  /// Percentile `share` (0..1) of the height steps between adjacent cells.
  double step_m(double share) const;
  /// The area within `reach_m` of cells whose height, averaged with the surrounding cells, exceeds
  /// `limit_m`. Valid polygons, accurate to 1.5 cells.
  Polygons near_off(double limit_m, double reach_m) const;
  /// Measured profile along the line through `at` toward a unit vector, to within half a cell:
  /// pairs of distance from `at` and height [m], sorted by distance.
  std::vector<Vec2d> cut(const Vec2d& at, const Vec2d& towards) const;

 private:
  struct Cell {
    double sum = 0, weight = 0, height_m = 0;
  };
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * columns_ + x; }
  /// Mean over 5 cm to each side, about the size of a foot: a bow across a whole floor does not
  /// count as roughness.
  double mean_about(int x, int y) const;

  Vec2d low_ = Vec2d::Zero();
  double cell_m_;
  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
  int occupied_ = 0;
  int about_ = 1;  // in cells
};

/// One per plane, by id - 1. `cell_m`: about the width of a voxel.
std::vector<Places> places_of(const FrameResult& result,
                              const std::vector<Outline>& outlines,
                              double cell_m);

}  // namespace planescope::planes
