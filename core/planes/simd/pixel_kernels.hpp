#pragma once

// Inner loops over the pixels of a depth image and their points, compiled once per instruction set.
// Lanes run over pixels or patches, and every result uses the same operations in the same order.
// Only raw pointers, so that no inline function compiled for one instruction set is linked into
// code for all.

#include <cstddef>
#include <cstdint>

#include "core/model/parallel.hpp"

namespace planescope::planes {

/// Outcome for a pixel. Pixels from `beyond_range` upward are points; `no_ray` has no ray that a
/// float can represent.
struct PixelFate {
  static constexpr int no_measurement = 0, no_ray = 1, beyond_range = 2, outside_cube = 3, kept = 4;
};

/// Back-projects a row of pixels, rotates it to the world frame, and crops it.
struct ProjectArgs {
  std::size_t count = 0;
  const std::uint16_t* depth = nullptr;             // [count]
  const double *ray_x = nullptr, *ray_y = nullptr;  // [count], both NaN if there is no ray
  double unit_m = 0;
  double turn[3][3] = {};          // world from sensor
  int most_counts = 0;             // largest count within range
  float from[3] = {}, to[3] = {};  // the cube, half-open, so every kept point has a cell
  float *x = nullptr, *y = nullptr, *z = nullptr;  // [count], for every fate
  std::uint8_t* fate = nullptr;                    // [count]
  std::uint64_t* pixels_of_fate = nullptr;         // [5], incremented
};

inline constexpr std::size_t kPatchLanes = 8;  // the number of patches is padded to a multiple
                                               // of this
inline constexpr std::size_t kInverseSums = 10;

/// Adds a row of pixels to the sums of the patches it crosses, pixel by pixel from the left.
struct PatchArgs {
  std::size_t patches = 0;                          // a multiple of kPatchLanes
  std::size_t pixels = 0;                           // per patch in this row
  const std::uint16_t* depth = nullptr;             // [pixels x patches], 0: ignored
  const double *ray_x = nullptr, *ray_y = nullptr;  // [pixels x patches]
  double unit_m = 0, max_depth_m = 0;
  double* sums = nullptr;  // [kInverseSums x patches]: xx xy x yy y 1 xw yw w ww, where w is the
                           // inverse depth
};

/// Tests which patches are on a plane of inverse depth, by their mean and normal.
struct OnPlaneArgs {
  std::size_t count = 0;         // a multiple of kPatchLanes
  const double* ray[3] = {};     // [count] mean rays
  const double* w = nullptr;     // [count] mean inverse depths
  const double* most = nullptr;  // [count] largest allowed residual
  const double* normal[3] = {};  // [count]
  double w_of_ray[3] = {};       // of the plane
  double plane_normal[3] = {}, least_cosine = 0;
  std::uint8_t* on = nullptr;  // [count] 0 or 1
};

/// Plane coordinates u, v and distance n of points, relative to `origin`.
struct LayFlatArgs {
  std::size_t count = 0;
  const float* points = nullptr;  // [count x 3]
  double origin[3] = {}, u_axis[3] = {}, v_axis[3] = {}, n_axis[3] = {};
  double *u = nullptr, *v = nullptr, *n = nullptr;  // [count]
};

/// Grid cells of positions along an axis, minus `first`.
struct CellArgs {
  std::size_t count = 0;
  const double* places = nullptr;  // [count], at most 2^30 cells from 0
  double cell = 1;                 // in the unit of `places`
  int first = 0;
  std::int32_t* cells = nullptr;  // [count]
};

struct PixelKernels {
  void (*project)(const ProjectArgs&);
  void (*add_to_patches)(const PatchArgs&);
  void (*find_on_plane)(const OnPlaneArgs&);
  void (*lay_flat)(const LayFlatArgs&);
  void (*find_cells)(const CellArgs&);
};
const PixelKernels& pixel_kernels(Simd simd);

extern const PixelKernels kPixelKernelsPlain, kPixelKernelsAvx2, kPixelKernelsAvx512;

}  // namespace planescope::planes
