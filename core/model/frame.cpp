// The origin to which float coordinates of a cloud are relative.

#include "core/model/frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace planescope {

Vec3d bulk_origin(std::span<const Vec3d> points) {
  constexpr double kLargest_m = 200;
  Eigen::AlignedBox3d bounds;
  for (const Vec3d& point : points)
    if (point.allFinite()) bounds.extend(point);
  if (bounds.isEmpty()) return Vec3d::Zero();
  if (bounds.sizes().maxCoeff() <= kLargest_m) return bounds.center().array().round();
  Vec3d median;
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (const Vec3d& point : points)
      if (point.allFinite()) values.push_back(point[axis]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = std::round(*middle);
  }
  return median;
}

}  // namespace planescope
