#pragma once

// What the charts of a page share. Included by line_chart.cpp and bar_chart.cpp only.

#include <span>
#include <string>
#include <vector>

#include "core/report/page/line_chart.hpp"

namespace planescope::report::chart {

inline constexpr int kWidth = 760, kHeight = 320;
inline constexpr int kLeft = 52, kRight = 176, kTop = 14, kBottom = 44;  // margins
inline constexpr int kColors = 10;                                       // .curve0 ... of the style

/// Values in whichever direction, spread evenly or by their logarithm.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  double share(double value) const;  // 0 at low, 1 at high
};

/// At most six round ticks: 1, 2 or 5 times a power of ten apart.
Axis axis_over(double low, double high);
/// Ticks at powers of ten and, where there are few, at 2 and 5 times them. `low` from above 0;
/// smaller values stand there.
Axis log_axis_over(double low, double high);

double y_of(const Axis& axis, double value);  // [px]
/// Lines across the plot at the ticks, and their values.
std::string y_grid(const Axis& axis);

/// The SVG element up to what it holds; it ends with "</svg>\n".
std::string begin_svg(const std::string& title);

/// Of the style, for the curve or bars at this place.
int color_of(const Curve& curve, std::size_t place);

/// Lowest and highest of all values that are there; 0 and 1 where none is.
struct Range {
  double low = 0, high = 1;
};
Range range_of(std::span<const Curve> curves);

}  // namespace planescope::report::chart
