#pragma once

#include <string>
#include <vector>

#include "core/report/page/line_chart.hpp"

namespace planescope::report {

struct BarChart {
  std::string title;                // read out where the chart is not seen
  std::vector<std::string> groups;  // names below them; "\n" breaks the line
  std::vector<Curve> bars;          // one value per group; NaN: no bar
  double low = 0, high = 100;       // what the axis spans; lower values are cut off
};

/// The chart as an SVG element, for a page with line_chart_style(). Each bar says its value where a
/// mouse rests on it.
std::string bar_chart(const BarChart& chart);

}  // namespace planescope::report
