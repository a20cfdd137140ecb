// Included by kernels_{plain,avx2,avx512}.cpp, which define PLANESCOPE_LANES (floats per register).
// Without AVX-512, back-projection takes 1.5 times as long, the gravity estimate 1.15 times and the
// measurements of planes 1.2 times, together 3 % of `segment` (640x480, one core of an AMD EPYC).

#include "core/planes/simd/pixel_kernels.hpp"

#pragma GCC diagnostic ignored "-Wunknown-pragmas"  // clang does not support ivdep

namespace planescope::planes {
namespace {

constexpr std::size_t kDoubles = PLANESCOPE_LANES / 2;
using Doubles = double __attribute__((vector_size(kDoubles * sizeof(double))));
using Longs = std::int64_t __attribute__((vector_size(kDoubles * sizeof(std::int64_t))));
using Ints = std::int32_t __attribute__((vector_size(kDoubles * sizeof(std::int32_t))));
using Counts = std::uint16_t __attribute__((vector_size(kDoubles * sizeof(std::uint16_t))));
using Bytes = std::uint8_t __attribute__((vector_size(kDoubles)));

inline Doubles load_doubles(const double* p) {
  Doubles v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store_doubles(double* p, Doubles v) { __builtin_memcpy(p, &v, sizeof v); }
inline Doubles load_counts(const std::uint16_t* p) {
  Counts counts;
  __builtin_memcpy(&counts, p, sizeof counts);
  return __builtin_convertvector(__builtin_convertvector(counts, Ints), Doubles);
}

void project(const ProjectArgs& args) {
  const ProjectArgs a = args;  // a copy that the output cannot alias
  const auto& t = a.turn;
  float *const x = a.x, *const y = a.y, *const z = a.z;
#pragma GCC ivdep
  for (std::size_t i = 0; i < a.count; ++i) {
    const double ahead = a.depth[i] * a.unit_m;
    const double right = a.ray_x[i] * ahead, down = a.ray_y[i] * ahead;
    // The same order of additions as in Eigen's matrix-vector product.
    x[i] = static_cast<float>((t[0][0] * right + t[0][1] * down) + t[0][2] * ahead);
    y[i] = static_cast<float>((t[1][0] * right + t[1][1] * down) + t[1][2] * ahead);
    z[i] = static_cast<float>(t[2][0] * right + (t[2][1] * down + t[2][2] * ahead));
  }
  int seen = 0, near = 0, inside = 0, measured = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < a.count; ++i) {
    const int counts = a.depth[i];
    // Each flag is 1 only if the previous one is, so their sum is the pixel's fate.
    const int is_measured = counts != 0;
    // Coordinates that overflow float make a pixel invalid: x - x is 0 only for finite numbers.
    const int is_seen = is_measured & (counts != 65535) & (x[i] - x[i] == 0) &
                        (y[i] - y[i] == 0) & (z[i] - z[i] == 0);
    const int is_near = is_seen & (counts <= a.most_counts);
    const int is_inside = is_near & (x[i] >= a.from[0]) & (y[i] >= a.from[1]) &
                          (z[i] >= a.from[2]) & (x[i] < a.to[0]) & (y[i] < a.to[1]) &
                          (z[i] < a.to[2]);
    a.fate[i] = static_cast<std::uint8_t>(is_measured + is_seen + is_near + is_inside);
    measured += is_measured, seen += is_seen, near += is_near, inside += is_inside;
  }
  a.pixels_of_fate[PixelFate::no_measurement] += a.count - measured;
  a.pixels_of_fate[PixelFate::no_ray] += measured - seen;
  a.pixels_of_fate[PixelFate::beyond_range] += seen - near;
  a.pixels_of_fate[PixelFate::outside_cube] += near - inside;
  a.pixels_of_fate[PixelFate::kept] += inside;
}

void add_to_patches(const PatchArgs& a) {
  const Doubles zero{}, one = zero + 1.0;
  for (std::size_t p = 0; p < a.patches; p += kDoubles) {
    Doubles sums[kInverseSums];
    for (std::size_t s = 0; s < kInverseSums; ++s)
      sums[s] = load_doubles(a.sums + s * a.patches + p);
    for (std::size_t i = 0; i < a.pixels; ++i) {
      const std::size_t at = i * a.patches + p;
      const Doubles z = load_counts(a.depth + at) * a.unit_m;
      const auto counts = (z > 0) & (z <= a.max_depth_m);
      // Ignored pixels add 0, which does not change the sums.
      const Doubles w = counts ? one / z : zero, n = counts ? one : zero;
      const Doubles x = counts ? load_doubles(a.ray_x + at) : zero;
      const Doubles y = counts ? load_doubles(a.ray_y + at) : zero;
      const Doubles products[kInverseSums] = {x * x, x * y, x, y * y, y, n, x * w, y * w, w, w * w};
      for (std::size_t s = 0; s < kInverseSums; ++s) sums[s] += products[s];
    }
    for (std::size_t s = 0; s < kInverseSums; ++s)
      store_doubles(a.sums + s * a.patches + p, sums[s]);
  }
}

void find_on_plane(const OnPlaneArgs& a) {
  for (std::size_t i = 0; i < a.count; i += kDoubles) {
    const auto dot = [i](const double* const(&of)[3], const double(&with)[3]) {
      return (with[0] * load_doubles(of[0] + i) + with[1] * load_doubles(of[1] + i)) +
             with[2] * load_doubles(of[2] + i);
    };
    const Doubles off = dot(a.ray, a.w_of_ray) - load_doubles(a.w + i);
    const Doubles most = load_doubles(a.most + i);
    const Longs on =
        (off <= most) & (-off <= most) & (dot(a.normal, a.plane_normal) >= a.least_cosine);
    const Bytes as_bytes = __builtin_convertvector(on & 1, Bytes);
    __builtin_memcpy(a.on + i, &as_bytes, sizeof as_bytes);
  }
}

void lay_flat(const LayFlatArgs& args) {
  const LayFlatArgs a = args;
  double *const u = a.u, *const v = a.v, *const n = a.n;
#pragma GCC ivdep
  for (std::size_t i = 0; i < a.count; ++i) {
    const double x = a.points[3 * i] - a.origin[0], y = a.points[3 * i + 1] - a.origin[1];
    const double z = a.points[3 * i + 2] - a.origin[2];
    u[i] = (a.u_axis[0] * x + a.u_axis[1] * y) + a.u_axis[2] * z;
    v[i] = (a.v_axis[0] * x + a.v_axis[1] * y) + a.v_axis[2] * z;
    n[i] = (a.n_axis[0] * x + a.n_axis[1] * y) + a.n_axis[2] * z;
  }
}

void find_cells(const CellArgs& args) {
  const CellArgs a = args;
#pragma GCC ivdep
  for (std::size_t i = 0; i < a.count; ++i) {
    const double cells_from_0 = a.places[i] / a.cell;
    const int cut = static_cast<int>(cells_from_0);
    a.cells[i] = cut - (static_cast<double>(cut) > cells_from_0) - a.first;
  }
}

}  // namespace
}  // namespace planescope::planes
