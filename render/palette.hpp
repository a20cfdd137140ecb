#pragma once

// The colors of data and of everything else, and scales of colors over a quantity in meters.

#include <algorithm>
#include <string>
#include <vector>

#include "core/model/palette.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/octree.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

Rgba with_alpha(Rgba color, std::uint8_t alpha);
Rgba mix(Rgba a, Rgba b, double share_b);  // opaque

/// Colors that stay apart under the common color-vision deficiencies (Okabe & Ito 2008), the same
/// in every picture, report and window.
Rgba case_color(planes::Case c);
Rgba label_color(Label label);  // h, v, unknown
/// From blue at -1, behind a plane, over near white on it to red at +1, before it.
Rgba residual_color(double share);
/// How sure a label is: from a dark grey that h and v share at margin 0 to the label's own color
/// at 1, lighter and more saturated all the way.
Rgba margin_color(Label label, double margin);
Rgba leftover_color();
/// Whether a plane carries a foot.
Rgba verdict_color(bool steppable);
/// Colors of planes: few, so that any two differ clearly, also for color-blind readers, and so does
/// each from leftover_color(). plane_colors.hpp says which plane gets which.
inline constexpr int kPlaneColors = static_cast<int>(kPlaneHues.size());
/// By color id, from 1 on; they repeat after kPlaneColors.
Rgba plane_color(int color_id);
/// A perceptually even ramp from dark at 0 to bright at 1, ordered for every eye.
Rgba ramp_color(double share);

/// The colors of everything that is not data.
struct ThemeColors {
  Rgba background_top, background_bottom;
  Rgba ink;                  // titles and text
  Rgba muted;                // subtitles, scale bar
  Rgba panel, panel_border;  // under overlay text
  Rgba halo;                 // around labels and arrows
  Rgba axis_x, axis_y, axis_z;
};
const ThemeColors& theme_colors(Theme theme);

struct ValueRange {
  double low_m = 0, high_m = 1;
  bool operator==(const ValueRange&) const = default;
};
/// Whether a scale can have it: finite ends in order, at least 0.1 mm apart.
bool is_range(const ValueRange& range);

struct ColorScale {
  /// rising: the more, the brighter; falling: the nearer; diverging: two hues about 0.
  enum class Map : std::uint8_t { rising, falling, diverging };
  std::string what;  // "depth"
  ValueRange range;  // values beyond it have the colors of its ends
  Map map = Map::rising;
  std::string at_low = {}, at_high = {};  // words for the ends: "behind", "before"

  Rgba color(double value_m) const;
  bool operator==(const ColorScale&) const = default;
};

/// The least of 1, 2 and 5 times a power of ten that is not below `least`.
double round_step(double least);
/// The value below which a share of them lies. Reorders them; not empty.
template <typename T>
T quantile(std::vector<T>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Round values in the range, ascending, all in one unit: meters, centimeters or millimeters.
struct ScaleTick {
  double value_m = 0;
  std::string text;  // "0.8"; with a sign where the scale has two sides
};
struct ScaleTicks {
  std::string unit;  // "m", "cm", "mm"
  std::vector<ScaleTick> ticks;
};
ScaleTicks ticks_of(const ColorScale& scale);

/// The range of all but the outermost 2 % of the values at either end, widened to round ends. Skips
/// values that are not finite; {0, 1} without others.
ValueRange robust_range(std::vector<float> values_m);
/// From 0 to the size that 95 % of the values stay below.
ValueRange range_from_zero(std::vector<float> sizes_m);

}  // namespace planescope::render
