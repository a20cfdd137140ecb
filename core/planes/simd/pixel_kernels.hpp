#pragma once

// The inner loops over the pixels of a depth image and their points, once per instruction set:
// lanes run over pixels, or over patches of them, and each number comes of the same operations in
// the same order. Raw pointers only, so that nothing compiled for one set can end up in code for
// all.

#include <cstddef>
#include <cstdint>

#include "core/model/parallel.hpp"

namespace planescope::planes {

/// What becomes of a pixel: those from `beyond_range` on are points, `no_ray` has none that a float
/// holds.
struct PixelFate {
  static constexpr int no_measurement = 0, no_ray = 1, beyond_range = 2, outside_cube = 3, kept = 4;
};

/// Back-projects pixels in a row, turns them and crops them.
struct ProjectArgs {
  std::size_t count = 0;
  const std::uint16_t* depth = nullptr;             // [count]
  const double *ray_x = nullptr, *ray_y = nullptr;  // [count], both NaN where there is no ray
  double unit_m = 0;
  double turn[3][3] = {};          // world from sensor
  int most_counts = 0;             // within range
  float from[3] = {}, to[3] = {};  // the cube, half-open, so that every kept point has a cell
  float *x = nullptr, *y = nullptr, *z = nullptr;  // [count], of any fate
  std::uint8_t* fate = nullptr;                    // [count]
  std::uint64_t* pixels_of_fate = nullptr;         // [5], to which these are added
};

inline constexpr std::size_t kPatchLanes = 8;  // the number of patches is padded to multiples of it
inline constexpr std::size_t kInverseSums = 10;

/// Adds a row of pixels to the sums of the patches that it crosses, pixel by pixel from the left.
struct PatchArgs {
  std::size_t patches = 0;                          // a multiple of kPatchLanes
  std::size_t pixels = 0;                           // of a patch in the row
  const std::uint16_t* depth = nullptr;             // [pixels x patches], 0: does not count
  const double *ray_x = nullptr, *ray_y = nullptr;  // [pixels x patches]
  double unit_m = 0, max_depth_m = 0;
  double* sums = nullptr;  // [kInverseSums x patches] of xx xy x yy y 1 xw yw w ww, w the inverse
                           // depth
};

/// Which patches lie on a plane of inverse depth, by their mean and their normal.
struct OnPlaneArgs {
  std::size_t count = 0;         // a multiple of kPatchLanes
  const double* ray[3] = {};     // [count] mean rays
  const double* w = nullptr;     // [count] mean inverse depths
  const double* most = nullptr;  // [count] by which it may be off
  const double* normal[3] = {};  // [count]
  double w_of_ray[3] = {};       // the plane's
  double plane_normal[3] = {}, least_cosine = 0;
  std::uint8_t* on = nullptr;  // [count] 0 or 1
};

/// Where points lie on a plane, and how far from it: u, v and n are its axes, about `origin`.
struct LayFlatArgs {
  std::size_t count = 0;
  const float* points = nullptr;  // [count x 3]
  double origin[3] = {}, u_axis[3] = {}, v_axis[3] = {}, n_axis[3] = {};
  double *u = nullptr, *v = nullptr, *n = nullptr;  // [count]
};

/// The cells of a grid in which places on an axis lie, less `first`.
struct CellArgs {
  std::size_t count = 0;
  const double* places = nullptr;  // [count], at most 2^30 cells from 0
  double cell = 1;                 // in the unit of the places
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
