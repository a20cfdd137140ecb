// Depth in meters becomes counts; the origin to which float coordinates of a cloud are relative.

#include "core/model/frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace planescope {

double round_meters(std::span<const float> meters, std::optional<double> unit_m, Image16& counts) {
  constexpr double kFine_m = 0.0002, kCoarse_m = 0.001, kInvalid = 65535, kMost = kInvalid - 1;
  constexpr double kFloatError = 2.5e-7;  // relative; of a float that was a whole number of units
  const auto is_measured = [](double z) { return z > 0 && std::isfinite(z); };
  if (!unit_m) {
    double farthest = 0;
    bool is_whole = true;
    for (const double z : meters) {
      if (!is_measured(z) || z > kMost * kCoarse_m * (1 + kFloatError)) continue;
      farthest = std::max(farthest, z);
      is_whole = is_whole && std::abs(std::round(z / kCoarse_m) * kCoarse_m - z) <= kFloatError * z;
    }
    const bool is_far = farthest > kMost * kFine_m * (1 + kFloatError);
    unit_m = is_whole || is_far ? kCoarse_m : kFine_m;
  }
  std::ranges::transform(meters, counts.data.begin(), [&](double z) {
    const double count = is_measured(z) ? std::min(std::round(z / *unit_m), kInvalid) : 0;
    return static_cast<std::uint16_t>(count);
  });
  return *unit_m;
}

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
