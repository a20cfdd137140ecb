#include "core/planes/segment/pixel_reach.hpp"

#include <algorithm>
#include <array>

#include "core/planes/segment/depth_kernels.hpp"

namespace planescope::planes {
namespace {

ReachRule rule_of(const NoiseModel& noise, const Vec3d& sensor, double reach_px) {
  const NoiseOptions& options = noise.options;
  ReachRule rule{
      .sensor = {sensor.x(), sensor.y(), sensor.z()},
      .by_range = noise.by_range,
      .sigmas = noise.of_spreads ? noise.of_spread_options.tau_sigmas : options.tau_sigmas,
      .growth_per_m = noise.growth_per_m,
      .constant_m = noise.constant_m,
      .least_m = options.tau_min_m,
      .greatest_m = options.tau_max_m,
      .limits_range_m = options.limits_range_m,
      .reach_px = reach_px,
      .most_px = kMostReach_px};
  if (!noise.estimated) {
    rule.by_range = false;
    rule.least_m = rule.greatest_m = options.fixed_tau_m;
  }
  return rule;
}

}  // namespace

PixelReach measure_pixel_reach(const PixelGrid& pixels,
                               std::span<const MeasuredRun> runs,
                               const Vec3d& sensor,
                               const NoiseModel& noise,
                               double reach_m,
                               Simd simd) {
  const DepthKernels& kernels = depth_kernels(simd);
  const ReachRule rule = rule_of(noise, sensor, reach_m * pixels.focal_px);
  const std::size_t count = pixels.point.size();
  PixelReach reach;
  reach.tau_m.reserve(count);
  reach.reach_px.reserve(count);
  constexpr std::size_t kAtOnce = 256;
  static_assert(kAtOnce % kPixelGroup == 0);
  std::array<Vec3f, kAtOnce> last;  // where groups end after the image
  std::array<double, kAtOnce> tau_m;
  std::array<std::int32_t, kAtOnce> px;
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    const std::size_t n = std::min(kAtOnce, count - first);
    const Vec3f* measured = pixels.measured.data() + first;
    if (n < kAtOnce) {
      last.fill(Vec3f::Zero());
      std::copy(measured, measured + n, last.begin());
      measured = last.data();
    }
    kernels.reach(measured->data(), kAtOnce, rule, tau_m.data(), px.data());
    reach.tau_m.insert(reach.tau_m.end(), tau_m.begin(), tau_m.begin() + n);
    reach.reach_px.insert(reach.reach_px.end(), px.begin(), px.begin() + n);
  }
  for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
    if (runs[r].is_measured()) continue;
    std::fill(reach.tau_m.begin() + runs[r].begin, reach.tau_m.begin() + runs[r + 1].begin, -1);
    std::fill(reach.reach_px.begin() + runs[r].begin, reach.reach_px.begin() + runs[r + 1].begin,
              std::uint8_t{0});
  }
  return reach;
}

}  // namespace planescope::planes
