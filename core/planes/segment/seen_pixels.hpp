#pragma once

// PixelGrid::seen() of many pixels side by side, several in a register.

#include <array>

#include "core/model/inverse_plane.hpp"
#include "core/planes/segment/depth_kernels.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

class SeenPixels {
 public:
  SeenPixels(const PixelGrid& pixels, const Vec3d& sensor, Simd simd = best_simd())
      : pixels_(pixels),
        sensor_{sensor.x(), sensor.y(), sensor.z()},
        last_group_(static_cast<std::size_t>(pixels.measured.size()) &
                    ~std::size_t{kPixelGroup - 1}),
        kernels_(depth_kernels(simd)) {}

  /// Calls visit(pixel, seen) for each in [begin, end).
  template <typename Visit>
  void visit(std::size_t begin, std::size_t end, const Visit& visit) {
    // Kernels read whole groups: those in which the image ends are looked at one by one.
    const Vec3d sensor(sensor_[0], sensor_[1], sensor_[2]);
    while (begin < end && begin + kAtOnce <= last_group_) {
      const std::size_t count = std::min(kAtOnce, end - begin);
      kernels_.see(pixels_.measured[begin].data(), static_cast<int>(count), sensor_.data(),
                   x_.data(), y_.data(), z_.data(), w_.data());
      for (std::size_t i = 0; i < count; ++i)
        visit(begin + i, PixelGrid::Seen{{x_[i], y_[i], z_[i]}, w_[i]});
      begin += count;
    }
    for (; begin < end; ++begin) visit(begin, pixels_.seen(begin, sensor));
  }

 private:
  static constexpr std::size_t kAtOnce = 64;
  static_assert(kAtOnce % kPixelGroup == 0);
  const PixelGrid& pixels_;
  const std::array<double, 3> sensor_;
  const std::size_t last_group_;
  const DepthKernels& kernels_;
  std::array<double, kAtOnce> x_, y_, z_, w_;
};

}  // namespace planescope::planes
