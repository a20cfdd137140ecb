#pragma once

// Colours along a scale: a quantity in metres, the range that is told apart, the ticks of its bar.

#include <string>
#include <vector>

#include "render/draw_list.hpp"

namespace planescope::render {

struct ValueRange {
  double low_m = 0, high_m = 1;
  bool operator==(const ValueRange&) const = default;
};
/// Whether a scale can have it: its ends are in order, apart by what one can tell apart, and
/// finite.
bool is_range(const ValueRange& range);

struct ColorScale {
  /// rising: the more, the brighter; falling: the nearer; diverging: two hues about 0.
  enum class Map : std::uint8_t { rising, falling, diverging };
  std::string what;  // "depth"
  ValueRange range;  // values beyond it have the colours of its ends
  Map map = Map::rising;
  std::string at_low = {}, at_high = {};  // words for the ends: "behind", "before"

  Rgba color(double value_m) const;
  bool operator==(const ColorScale&) const = default;
};

/// Round values in the range, ascending, all in one unit: metres, centimetres or millimetres.
struct ScaleTick {
  double value_m = 0;
  std::string text;  // "0.8"; with a sign where the scale has two sides
};
struct ScaleTicks {
  std::string unit;  // "m", "cm", "mm"
  std::vector<ScaleTick> ticks;
};
ScaleTicks ticks_of(const ColorScale& scale);

/// Where all but the outermost values lie, 2 % at either end, widened to round ends. Values that
/// are no numbers are passed over; without others it is that of {0, 1}.
ValueRange robust_range(std::vector<float> values_m);
/// From 0 to where 95 % of the sizes are, and the same about 0.
ValueRange range_from_zero(std::vector<float> sizes_m);
ValueRange range_about_zero(std::vector<float> sizes_m);

}  // namespace planescope::render
