#include "render/color_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/palette.hpp"

namespace planescope::render {
namespace {

constexpr double kLeastRange_m = 0.001;  // of a scale: what no sensor tells apart is no colour

/// 1, 2 or 5 times a power of ten, the least that is not below.
double round_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  return 10 * decade;
}

/// The value below which a share of them lies. Reorders them.
double quantile(std::vector<float>& values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

void drop_unknown(std::vector<float>& values) {
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
}

double most_of(std::vector<float> sizes_m) {
  drop_unknown(sizes_m);
  if (sizes_m.empty()) return 1;
  for (float& size : sizes_m) size = std::abs(size);
  return round_step(std::max(quantile(sizes_m, 0.95), kLeastRange_m));
}

}  // namespace

bool is_range(const ValueRange& range) {
  constexpr double kMost_m = 1e5, kLeast_m = 1e-4;
  return std::abs(range.low_m) <= kMost_m && std::abs(range.high_m) <= kMost_m &&
         range.high_m - range.low_m >= kLeast_m;
}

Rgba ColorScale::color(double value_m) const {
  const double share = std::clamp((value_m - range.low_m) / (range.high_m - range.low_m), 0.0, 1.0);
  switch (map) {
    case Map::falling:
      return ramp_color(1 - share);
    case Map::diverging:
      return residual_color(2 * share - 1);
    default:
      return ramp_color(share);
  }
}

ScaleTicks ticks_of(const ColorScale& scale) {
  constexpr double kMostSteps = 5;
  const auto [low_m, high_m] = scale.range;
  const double most_m = std::max(std::abs(low_m), std::abs(high_m));
  const double unit_m = most_m >= 1 ? 1 : most_m >= 0.1 ? 0.01 : 0.001;
  ScaleTicks result{most_m >= 1 ? "m" : most_m >= 0.1 ? "cm" : "mm", {}};
  const double low = low_m / unit_m, high = high_m / unit_m;
  const double step = round_step((high - low) / kMostSteps);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const bool signs = scale.map == ColorScale::Map::diverging;
  for (double k = std::ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; ++k) {
    const double value = k == 0 ? 0 : k * step;  // no -0
    result.ticks.push_back({value * unit_m, signs && value != 0
                                                ? fmt::format("{:+.{}f}", value, decimals)
                                                : fmt::format("{:.{}f}", value, decimals)});
  }
  return result;
}

ValueRange robust_range(std::vector<float> values_m) {
  drop_unknown(values_m);
  if (values_m.empty()) return {0, 1};
  const double low = quantile(values_m, 0.02), high = quantile(values_m, 0.98);
  const double step = round_step(std::max(high - low, kLeastRange_m) / 10);
  const double from = std::floor(low / step + 1e-6), to = std::ceil(high / step - 1e-6);
  return {from * step, std::max(to, from + 1) * step};
}

ValueRange range_from_zero(std::vector<float> sizes_m) { return {0, most_of(std::move(sizes_m))}; }

ValueRange range_about_zero(std::vector<float> sizes_m) {
  const double most = most_of(std::move(sizes_m));
  return {-most, most};
}

}  // namespace planescope::render
