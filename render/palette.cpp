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

// Chosen greedily in OKLab from a grid of hues, chromas and lightnesses that show on both themes:
// each the farthest from the eight before it, as seen by normal, protanopic and deuteranopic eyes
// (Machado et al. 2009), and unlike any earlier one.
constexpr std::array<std::uint32_t, kPlaneColors> kPlaneHues = {
    0x0072B2, 0xB4481E, 0xABAC1D, 0xCE83DE, 0x84D9F3, 0xFBBA96, 0x4B916E, 0x8267E2,
    0xAE388F, 0x52A9FE, 0x7E541B, 0xD37812, 0xF46EB4, 0x73D25D, 0xDDBBF7, 0xBC5F70,
    0x4861D5, 0x54578F, 0xA492FB, 0x227008, 0x4CAB34, 0x58B7B1, 0xF0C543, 0x8874AE,
    0xBF2F56, 0xF47C6B, 0x2559B0, 0xE98DFE, 0xACD9A2, 0x918112, 0x116E56, 0x397BE9};

// Viridis (Smith & van der Walt 2015) at every eighth.
constexpr std::array<std::uint32_t, 9> kViridis = {0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C,
                                                   0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725};

constexpr double kMaxAngle_deg = 10;
constexpr double kMaxOffset_m = 0.05;

// Whether `now` may be the plane `before` of the previous frame. Offsets are compared where the
// planes are, not at the origin: far from it a small turn of the normal moves the offset a lot.
bool continues(const ColoredPlane& before, const ColoredPlane& now) {
  if (before.label != now.label) return false;
  const double cosine = std::abs(before.normal.dot(now.normal));
  if (cosine < std::cos(kMaxAngle_deg * M_PI / 180)) return false;
  return std::abs(before.normal.dot(now.centroid) - before.offset_m) <= kMaxOffset_m &&
         std::abs(now.normal.dot(before.centroid) - now.offset_m) <= kMaxOffset_m;
}

}  // namespace

Rgba case_color(planes::Case c) {
  switch (c) {
    case planes::Case::I:
      return rgb(0xE69F00);
    case planes::Case::II:
      return rgb(0xB1B1B1);
    case planes::Case::III:
      return rgb(0x3E62B7);
    case planes::Case::IV:
      return rgb(0x009E73);
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

Rgba verdict_color(bool steppable) { return rgb(steppable ? 0x009E73 : 0xD55E00); }

Rgba plane_color(int plane_id) {
  const int n = static_cast<int>(kPlaneHues.size());
  return rgb(kPlaneHues[static_cast<std::size_t>((((plane_id - 1) % n) + n) % n)]);
}

void keep_colors(const std::vector<ColoredPlane>& before, std::vector<ColoredPlane>& now) {
  struct Pair {
    double distance_m = 0;
    std::size_t before = 0, now = 0;
  };
  std::vector<Pair> pairs;
  for (std::size_t b = 0; b < before.size(); ++b) {
    for (std::size_t n = 0; n < now.size(); ++n) {
      if (!continues(before[b], now[n])) continue;
      pairs.push_back({(before[b].centroid - now[n].centroid).norm(), b, n});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& x, const Pair& y) { return x.distance_m < y.distance_m; });

  std::vector<bool> continued(before.size());
  std::vector<int> taken;
  for (ColoredPlane& plane : now) plane.color_id = 0;
  for (const Pair& pair : pairs) {
    if (continued[pair.before] || now[pair.now].color_id != 0) continue;
    continued[pair.before] = true;
    now[pair.now].color_id = before[pair.before].color_id;
    taken.push_back(before[pair.before].color_id);
  }
  int next = 1;
  for (ColoredPlane& plane : now) {
    if (plane.color_id != 0) continue;
    while (std::find(taken.begin(), taken.end(), next) != taken.end()) ++next;
    plane.color_id = next++;
  }
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
