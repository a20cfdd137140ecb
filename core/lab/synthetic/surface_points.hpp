#pragma once

// Points evenly spread over surfaces.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/random.hpp"
#include "core/model/types.hpp"

namespace planescope::lab {

struct Rectangle {
  Vec3d corner;
  Vec3d side_u;
  Vec3d side_v;
  Vec3d normal;         // unit, outward
  bool halved = false;  // the triangle at `corner`, cut off along the diagonal
  double area() const {
    return halved ? side_u.cross(side_v).norm() / 2 : side_u.norm() * side_v.norm();
  }
};

struct SurfacePoints {
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> rectangle;  // that each point lies on
};

/// `count` points evenly spread over the surface, turned about the origin: farthest points of a
/// dense random sampling; 0 = all of that.
SurfacePoints sample_surface(std::span<const Rectangle> rectangles,
                             std::size_t count,
                             const Mat3d& turn,
                             Random& random);

/// A point with Gaussian noise of standard deviation `sigma_m` on every coordinate; draws nothing
/// where that is 0.
Vec3f with_noise(const Vec3f& point, double sigma_m, Random& random);

/// Farthest point sampling: indices of `count` points (all, where there are fewer), each the one
/// farthest from those before it, starting with point 0; ties go to the lower index.
std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count);

}  // namespace planescope::lab
