#include "core/planes/segment/depth_kernels.hpp"

namespace planescope::planes {
namespace {

// As wide as the registers; pixels stand anywhere.
using Doubles [[gnu::vector_size(8 * PLANESCOPE_LANES)]] = double;
using Longs [[gnu::vector_size(8 * PLANESCOPE_LANES)]] = std::int64_t;
using Ints [[gnu::vector_size(4 * PLANESCOPE_LANES)]] = std::int32_t;

template <typename Vector, typename Value>
Vector load(const Value* from) {
  Vector v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}

Doubles larger(const Doubles& a, const Doubles& b) { return a < b ? b : a; }
Doubles smaller(const Doubles& a, const Doubles& b) { return b < a ? b : a; }

Doubles square_root(Doubles v) {
  for (int lane = 0; lane < PLANESCOPE_LANES; ++lane) v[lane] = __builtin_sqrt(v[lane]);
  return v;
}

/// Three coordinates of a lane after those of the one before.
Doubles coordinate(const float* measured, int axis) {
  Doubles v;
  for (int lane = 0; lane < PLANESCOPE_LANES; ++lane) v[lane] = measured[3 * lane + axis];
  return v;
}

void see(const float* measured,
         int count,
         const double* sensor,
         double* x,
         double* y,
         double* z,
         double* w) {
  const Doubles zero = {};
  double* const to[] = {x, y, z};
  for (int i = 0; i < count; i += PLANESCOPE_LANES) {
    Doubles ray[3];
    for (int axis = 0; axis < 3; ++axis)
      ray[axis] = coordinate(measured + 3 * i, axis) - sensor[axis];
    const Doubles range = square_root(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    const Doubles inverse = 1 / larger(range, zero + 1e-3);
    for (int axis = 0; axis < 3; ++axis) {
      ray[axis] *= inverse;
      __builtin_memcpy(to[axis] + i, &ray[axis], sizeof inverse);
    }
    __builtin_memcpy(w + i, &inverse, sizeof inverse);
  }
}

void reach(
    const float* measured, int count, const ReachRule& rule, double* tau_m, std::int32_t* px) {
  const Doubles zero = {};
  for (int i = 0; i < count; i += PLANESCOPE_LANES) {
    const Doubles x = coordinate(measured + 3 * i, 0) - rule.sensor[0];
    const Doubles y = coordinate(measured + 3 * i, 1) - rule.sensor[1];
    const Doubles z = coordinate(measured + 3 * i, 2) - rule.sensor[2];
    const Doubles range = square_root(x * x + y * y + z * z);
    Doubles sigma = zero + rule.constant_m, greatest = zero + rule.greatest_m;
    if (rule.by_range) {
      sigma = rule.growth_per_m * range * range;
      const Doubles ratio = range / rule.limits_range_m;
      greatest *= larger(zero + 1, ratio * ratio);
    }
    const Doubles least = zero + rule.least_m;
    const Doubles tau =
        larger(smaller(larger(rule.sigmas * sigma, least), larger(least, greatest)), zero + 1e-9);
    const Doubles reach_px =
        smaller(larger(rule.reach_px / larger(range, zero + 0.01), zero + 1), zero + rule.most_px);
    const Ints whole_px = __builtin_convertvector(reach_px, Ints);
    __builtin_memcpy(tau_m + i, &tau, sizeof tau);
    __builtin_memcpy(px + i, &whole_px, sizeof whole_px);
  }
}

void lay_on(const PixelRow& row,
            int count,
            const PlanePlace& plane,
            std::int32_t* off_um,
            std::int32_t* counts) {
  for (int i = 0; i < count; i += PLANESCOPE_LANES) {
    const Doubles dx = load<Doubles>(row.x + i) - plane.centroid[0];
    const Doubles dy = load<Doubles>(row.y + i) - plane.centroid[1];
    const Doubles dz = load<Doubles>(row.z + i) - plane.centroid[2];
    // PlaneFit::distance_m(), its terms in the same order.
    const Doubles off_m = plane.normal[0] * dx + plane.normal[1] * dy + plane.normal[2] * dz;
    const Doubles tau_m = load<Doubles>(row.tau_m + i);
    const Longs may_lie_on_it = (off_m <= 2 * tau_m) & (-off_m <= 2 * tau_m);
    const Doubles from_above = off_m < tau_m ? off_m : tau_m;
    const Doubles limited_m = from_above < -tau_m ? -tau_m : from_above;
    const Ints on = __builtin_convertvector(may_lie_on_it, Ints);  // all bits of those, else none
    const Ints limited_um = __builtin_convertvector(limited_m * 1e6, Ints) & on;
    const Ints own = (load<Ints>(row.plane + i) == plane.plane) & kOwnPixel;
    const Ints count_of = (on & 1) + own;
    __builtin_memcpy(off_um + i, &limited_um, sizeof limited_um);
    __builtin_memcpy(counts + i, &count_of, sizeof count_of);
  }
}

}  // namespace
}  // namespace planescope::planes
