#pragma once

// Vectors, poses, boxes and images.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace planescope {

using Vec2d = Eigen::Vector2d;
using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;
using Mat3d = Eigen::Matrix3d;
/// A rigid transform. T_a_b maps coordinates in frame b to coordinates in frame a.
using Pose = Eigen::Isometry3d;

/// Axis-aligned box; empty until the first point.
struct Bounds {
  Vec3d min = Vec3d::Constant(1e300);
  Vec3d max = Vec3d::Constant(-1e300);

  void add(const Vec3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  Bounds& operator+=(const Bounds& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
    return *this;
  }
};

/// A row-major image, `channels` interleaved values per pixel, row 0 at the top.
template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<T> data;  // height * width * channels

  Image() = default;
  Image(int w, int h, int c = 1, T fill = T{})
      : width(w), height(h), channels(c), data(static_cast<std::size_t>(w) * h * c, fill) {}

  bool empty() const { return data.empty(); }
  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
  T& at(int x, int y, int c = 0) {
    return data[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
  const T& at(int x, int y, int c = 0) const {
    return data[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
};

using Image8 = Image<std::uint8_t>;    // 1 gray, 3 RGB or 4 RGBA channels
using Image16 = Image<std::uint16_t>;  // 1 channel: depth counts, plane ids

}  // namespace planescope
