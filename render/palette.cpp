// Color palettes for planes, cases, labels and themes, and ticks of color scales.

#include "render/palette.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace planescope::render {
namespace {

constexpr Rgba rgb(std::uint32_t hex) {
  return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8 & 0xFF),
          static_cast<std::uint8_t>(hex & 0xFF)};
}

// Viridis (Smith & van der Walt 2015) in steps of one eighth.
constexpr std::array<std::uint32_t, 9> kViridis = {0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C,
                                                   0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725};

// By case and by label; the first entry is for none.
constexpr std::array<std::uint32_t, 5> kCaseHues = {0x8A8F98, 0xE69F00, 0xA83C6C, 0x3E62B7,
                                                    0x18CC90};
constexpr std::array<std::uint32_t, 3> kLabelHues = {0x9A9DA3, 0x0072B2, 0xE69F00};

constexpr double kLeastRange_m = 0.001;  // smallest range of a scale; below the resolution
                                         // of sensors

void drop_unknown(std::vector<float>& values) {
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
}

}  // namespace

Rgba with_alpha(Rgba color, std::uint8_t alpha) {
  color.a = alpha;
  return color;
}

Rgba mix(Rgba a, Rgba b, double share_b) {
  const auto blend = [&](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>(std::lround(x + share_b * (y - x)));
  };
  return {blend(a.r, b.r), blend(a.g, b.g), blend(a.b, b.b), 255};
}

Rgba case_color(planes::Case c) { return rgb(kCaseHues[static_cast<std::size_t>(c)]); }

Rgba label_color(Label label) { return rgb(kLabelHues[static_cast<std::size_t>(label)]); }

Rgba margin_color(Label label, double margin) {
  if (label == Label::unknown) return label_color(label);
  return mix(rgb(0x3E3E3E), label_color(label), std::clamp(margin, 0.0, 1.0));
}

Rgba residual_color(double share) {
  const double t = std::clamp(share, -1.0, 1.0);
  return mix(rgb(0xF7F7F7), t < 0 ? rgb(0x2166AC) : rgb(0xB2182B), std::abs(t));
}

Rgba leftover_color() { return rgb(0x8A8F98); }

Rgba verdict_color(bool steppable) { return rgb(steppable ? 0x18CC90 : 0xD55E00); }

Rgba plane_color(int color_id) { return rgb(plane_hue(color_id)); }

Rgba ramp_color(double share) {
  const double t = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(t), kViridis.size() - 2);
  return mix(rgb(kViridis[i]), rgb(kViridis[i + 1]), t - static_cast<double>(i));
}

const ThemeColors& theme_colors(Theme theme) {
  static const ThemeColors light = {
      .background_top = {252, 252, 253},
      .background_bottom = {234, 237, 241},
      .ink = {28, 32, 38},
      .muted = {92, 99, 110},
      .panel = {255, 255, 255, 225},
      .panel_border = {28, 32, 38, 34},
      .halo = {255, 255, 255, 235},
      .axis_x = {213, 94, 0},
      .axis_y = {0, 140, 102},
      .axis_z = {0, 114, 178},
  };
  static const ThemeColors dark = {
      .background_top = {30, 33, 38},
      .background_bottom = {17, 19, 22},
      .ink = {233, 236, 240},
      .muted = {156, 163, 173},
      .panel = {24, 27, 31, 225},
      .panel_border = {255, 255, 255, 34},
      .halo = {12, 13, 15, 235},
      .axis_x = {240, 128, 48},
      .axis_y = {32, 186, 142},
      .axis_z = {86, 180, 233},
  };
  return theme == Theme::light ? light : dark;
}

double round_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  return 10 * decade;
}

bool is_range(const ValueRange& range) {
  constexpr double kMost_m = 1e5, kLeast_m = 1e-4;
  return std::abs(range.low_m) <= kMost_m && std::abs(range.high_m) <= kMost_m &&
         range.high_m - range.low_m >= kLeast_m;
}

Rgba ColorScale::color(double value_m) const {
  const double share = std::clamp((value_m - range.low_m) / (range.high_m - range.low_m), 0.0, 1.0);
  if (map == Map::diverging) return residual_color(2 * share - 1);
  return ramp_color(map == Map::falling ? 1 - share : share);
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
    const double value = k == 0 ? 0 : k * step;  // avoid -0
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

ValueRange range_from_zero(std::vector<float> sizes_m) {
  drop_unknown(sizes_m);
  if (sizes_m.empty()) return {0, 1};
  for (float& size : sizes_m) size = std::abs(size);
  return {0, round_step(std::max<double>(quantile(sizes_m, 0.95), kLeastRange_m))};
}

}  // namespace planescope::render
