#include "render/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace planescope::render {
namespace {

constexpr Rgba rgb(std::uint32_t hex) {
  return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8 & 0xFF),
          static_cast<std::uint8_t>(hex & 0xFF)};
}

Rgba mixed(Rgba a, Rgba b, double share_b) {
  const auto mix = [share_b](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + share_b * (to - from)));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// Found by search over a grid of OKLCh: the smallest distance between any two, and to
// leftover_color(), is as large as possible for normal, protanopic, deuteranopic and tritanopic
// eyes (Machado et al. 2009), where distances for normal eyes count 1/1.3. In OKLab times 100, it
// is 12.5 for normal eyes and 9.1 for others; to leftover_color() 12.0 and 10.0. Ordered so that
// each is far from those before it; orange and amber, which are like marks of the label mode, come
// last.
constexpr std::array<std::uint32_t, kPlaneColors> kPlaneHues = {
    0x3E7CBD, 0xB0000F, 0x80DEF5, 0xB76A32, 0xBD9EDE, 0x65BC82, 0xBED995,
    0x2C6149, 0x8D2198, 0x8A6283, 0x6B44DE, 0xD06AFA, 0xF58324, 0xFDB803};

// Viridis (Smith & van der Walt 2015) at every eighth.
constexpr std::array<std::uint32_t, 9> kViridis = {0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C,
                                                   0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725};

}  // namespace

Rgba case_color(planes::Case c) {
  switch (c) {
    case planes::Case::I:
      return rgb(0xE69F00);
    case planes::Case::II:
      return rgb(0xA83C6C);
    case planes::Case::III:
      return rgb(0x3E62B7);
    case planes::Case::IV:
      return rgb(0x18CC90);
    case planes::Case::none:
      break;
  }
  return rgb(0x8A8F98);
}

Rgba label_color(Label label) {
  switch (label) {
    case Label::h:
      return rgb(0x0072B2);
    case Label::v:
      return rgb(0xE69F00);
    case Label::unknown:
      break;
  }
  return rgb(0x9A9DA3);
}

Rgba margin_color(Label label, double margin) {
  if (label == Label::unknown) return label_color(label);
  return mixed(rgb(0x3E3E3E), label_color(label), std::clamp(margin, 0.0, 1.0));
}

Rgba residual_color(double share) {
  const double t = std::clamp(share, -1.0, 1.0);
  return mixed(rgb(0xF7F7F7), t < 0 ? rgb(0x2166AC) : rgb(0xB2182B), std::abs(t));
}

Rgba leftover_color() { return rgb(0x8A8F98); }

Rgba verdict_color(bool steppable) { return rgb(steppable ? 0x18CC90 : 0xD55E00); }

Rgba plane_color(int color_id) {
  const int n = kPlaneColors;
  return rgb(kPlaneHues[static_cast<std::size_t>((((color_id - 1) % n) + n) % n)]);
}

Rgba ramp_color(double share) {
  const double t = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(t), kViridis.size() - 2);
  return mixed(rgb(kViridis[i]), rgb(kViridis[i + 1]), t - static_cast<double>(i));
}

Rgba depth_color(double depth_m, double max_m) {
  if (!(depth_m > 0) || !(max_m > 0)) return rgb(0x8A8F98);
  return ramp_color(1 - std::min(depth_m / max_m, 1.0));
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

}  // namespace planescope::render
