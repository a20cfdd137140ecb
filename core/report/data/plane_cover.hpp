#pragma once

// What the points of a plane cover of it.

#include <vector>

#include "core/model/types.hpp"

namespace planescope::report {

/// Points on a plane, each at (u, v) [m].
struct FlatPoints {
  std::vector<double> u, v;

  std::size_t size() const { return u.size(); }
  Vec2d operator[](std::size_t i) const { return {u[i], v[i]}; }
  void resize(std::size_t count) { u.resize(count), v.resize(count); }
};

struct Cover {
  std::size_t cells = 0;    // of a grid that hold a point
  std::vector<Vec2d> hull;  // as convex_hull() of all points, bit for bit
};

Cover cover_of(const FlatPoints& points, double cell_m);

}  // namespace planescope::report
