#pragma once

// Inner loops over pixels, for each instruction set. The sources behind this header include nothing
// but it: an inline function of a shared header could end up in the program in their version, for
// processors that not everybody has.

#include <cstdint>

#include "core/model/simd.hpp"

namespace planescope::planes {

/// Pixels come in groups: what a kernel reads and writes must have room up to a multiple of these.
inline constexpr int kPixelGroup = 8;

/// Pixels side by side: where they are [m], tau [m] (-1 where nothing was measured) and on which
/// plane their points are.
struct PixelRow {
  const double* x;
  const double* y;
  const double* z;
  const double* tau_m;
  const std::int32_t* plane;
};
/// A plane by its number.
struct PlanePlace {
  double normal[3];
  double centroid[3];  // [m]
  std::int32_t plane;
};
/// In counts: a pixel that is on the plane; 1 more where it may lie on it.
inline constexpr std::int32_t kOwnPixel = 1 << 16;

/// NoiseModel::tau(), and the reach in pixels, of what is measured from the sensor.
struct ReachRule {
  double sensor[3];
  bool by_range;
  double sigmas, growth_per_m, constant_m;
  double least_m, greatest_m, limits_range_m;
  double reach_px;  // at 1 m
  double most_px;
};

struct DepthKernels {
  /// PixelGrid::seen() of `count` pixels side by side: rays by coordinates, and w.
  void (*see)(const float* measured,
              int count,
              const double* sensor,
              double* x,
              double* y,
              double* z,
              double* w);

  /// Of each of `count` pixels at these places (x, y and z): its tau, and its reach.
  void (*reach)(
      const float* measured, int count, const ReachRule& rule, double* tau_m, std::int32_t* px);

  /// Of each of `count` pixels: its signed distance from the plane, at most tau, where it may lie
  /// on it (is no farther than 2 tau), else 0 [um, rounded to 0]; and its count.
  void (*lay_on)(const PixelRow& row,
                 int count,
                 const PlanePlace& plane,
                 std::int32_t* off_um,
                 std::int32_t* counts);
};
const DepthKernels& depth_kernels(Simd simd);

extern const DepthKernels kDepthKernelsPlain;
extern const DepthKernels kDepthKernelsAvx2;
extern const DepthKernels kDepthKernelsAvx512;

}  // namespace planescope::planes
