#pragma once

// Colors of data and themes, and color scales for quantities in meters.

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

/// Colors that are distinguishable with the common color-vision deficiencies (Okabe & Ito 2008),
/// the same in all pictures, reports and windows.
Rgba case_color(planes::Case c);
Rgba label_color(Label label);  // h, v, unknown
/// Blue at -1 (behind a plane), near white on it, red at +1 (in front).
Rgba residual_color(double share);
/// Classifier margin of a label: from a common dark gray for h and v at margin 0 to the label's own
/// color at 1, with increasing lightness and saturation.
Rgba margin_color(Label label, double margin);
Rgba leftover_color();
/// Color for planes that are steppable or not.
Rgba verdict_color(bool steppable);
/// A small palette for planes. All pairs of colors, including leftover_color(), differ clearly,
/// also for color-blind readers. plane_colors.hpp assigns them to planes.
inline constexpr int kPlaneColors = static_cast<int>(kPlaneHues.size());
/// By color id, from 1; the palette repeats after kPlaneColors.
Rgba plane_color(int color_id);
/// A perceptually uniform ramp from dark at 0 to bright at 1, ordered for all types of vision.
Rgba ramp_color(double share);

/// Colors other than data.
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
/// Whether a scale can have this range: finite limits in order, at least 0.1 mm apart.
bool is_range(const ValueRange& range);

struct ColorScale {
  /// rising: larger is brighter; falling: smaller is brighter; diverging: two hues around 0.
  enum class Map : std::uint8_t { rising, falling, diverging };
  std::string what;  // "depth"
  ValueRange range;  // values outside get the color of the nearest limit
  Map map = Map::rising;
  std::string at_low = {}, at_high = {};  // names of the ends: "behind", "in front"

  Rgba color(double value_m) const;
  bool operator==(const ColorScale&) const = default;
};

/// The smallest of 1, 2 and 5 times a power of ten that is at least `least`.
double round_step(double least);
/// The value below which the given share of values is. Reorders the values, which must not
/// be empty.
template <typename T>
T quantile(std::vector<T>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Round values in the range, ascending, in one common unit: meters, centimeters or millimeters.
struct ScaleTick {
  double value_m = 0;
  std::string text;  // "0.8"; with a sign if the scale has two sides
};
struct ScaleTicks {
  std::string unit;  // "m", "cm", "mm"
  std::vector<ScaleTick> ticks;
};
ScaleTicks ticks_of(const ColorScale& scale);

/// Range of all but the outermost 2 % of the values at either end, widened to round limits. Ignores
/// non-finite values; {0, 1} if there are no others.
ValueRange robust_range(std::vector<float> values_m);
/// From 0 to the 95th percentile of the sizes.
ValueRange range_from_zero(std::vector<float> sizes_m);

}  // namespace planescope::render
