#include "core/report/page/line_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <kainjow/mustache.hpp>

#include "core/report/page/chart_parts.hpp"

namespace planescope::report {
namespace {

using namespace chart;
using kainjow::mustache::html_escape;

constexpr std::size_t kMostDots = 60;  // of more the line alone is clearer

double x_of(const Axis& axis, double value) {
  return kLeft + axis.share(value) * (kWidth - kLeft - kRight);
}

/// Where x is a count, there is nothing between whole numbers.
std::string x_ticks(const Axis& axis, const LineChart& chart) {
  const auto is_whole = [](double value) { return std::abs(value - std::round(value)) < 1e-9; };
  const bool counts = std::ranges::all_of(chart.x, is_whole);
  std::string svg;
  for (const double tick : axis.ticks) {
    if (counts && !is_whole(tick)) continue;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.6g}</text>\n",
                       x_of(axis, tick), kHeight - kBottom + 18, tick);
  }
  return svg + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                           (kLeft + kWidth - kRight) / 2, kHeight - 6, html_escape(chart.x_name));
}

std::string mark(const LineChart& chart, const Axis& axis) {
  if (!chart.x_mark || *chart.x_mark > axis.high) return "";
  const double x = x_of(axis, *chart.x_mark);
  return fmt::format(
      "<path class=\"mark\" d=\"M{0:.1f} {1}V{2}\"/>"
      "<text x=\"{3:.1f}\" y=\"{4}\">{5}</text>\n",
      x, kTop, kHeight - kBottom, x + 6, kHeight - kBottom - 8, html_escape(chart.mark_name));
}

Axis y_axis(const LineChart& chart) {
  const Range range = range_of(chart.curves);
  if (chart.log_from > 0) return log_axis_over(chart.log_from, range.high);
  return axis_over(chart.from_zero ? std::fmin(0, range.low) : range.low, range.high);
}

/// Path data through the values that are there, to the first one twice: a curve of one point is a
/// dot.
std::string path_of(const LineChart& chart, const Curve& curve, const Axis& x, const Axis& y) {
  std::string path;
  for (std::size_t i = 0; i < chart.x.size(); ++i) {
    if (std::isnan(curve.values[i])) continue;
    const std::string at =
        fmt::format("{:.1f} {:.1f}", x_of(x, chart.x[i]), y_of(y, curve.values[i]));
    if (path.empty()) path = "M" + at;
    path += "L" + at;
  }
  return path;
}

}  // namespace

std::string line_chart(const LineChart& chart) {
  assert(!chart.x.empty() && !chart.curves.empty());
  const Axis x = axis_over(chart.x_from, chart.x.back());
  const Axis y = y_axis(chart);
  std::string svg = begin_svg(chart.title) + y_grid(y) + x_ticks(x, chart) + mark(chart, x);
  for (std::size_t c = 0; c < chart.curves.size(); ++c) {
    const Curve& curve = chart.curves[c];
    assert(curve.values.size() == chart.x.size());
    const int legend_x = kWidth - kRight + 16, legend_y = kTop + 8 + 20 * static_cast<int>(c);
    for (std::size_t i = 0; i < chart.x.size() && chart.x.size() <= kMostDots; ++i)
      if (!std::isnan(curve.values[i]))
        svg += fmt::format("<circle class=\"bar{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n",
                           color_of(curve, c), x_of(x, chart.x[i]), y_of(y, curve.values[i]));
    svg += fmt::format(
        "<path class=\"curve{}\" d=\"{}M{} {}h16\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
        color_of(curve, c), path_of(chart, curve, x, y), legend_x, legend_y, legend_x + 24,
        legend_y + 4, html_escape(curve.name));
  }
  return svg + "</svg>\n";
}

std::string line_chart_style() {
  // Told apart by all kinds of colour vision (Okabe and Ito), on dark pages lighter; those from the
  // eighth on only where a chart has that many.
  constexpr const char* kOnLight[kColors] = {"#0072b2", "#d55e00", "#009e73", "#b65c94", "#b98500",
                                             "#3f9fd0", "#555555", "#7a3fb0", "#6b8e23", "#a3261b"};
  constexpr const char* kOnDark[kColors] = {"#4ba3dd", "#f08a4b", "#2fc79a", "#e39cc4", "#e9b93d",
                                            "#8fd0f5", "#b0b0b0", "#b78ae6", "#a9c95a", "#f0948a"};
  std::string style =
      ".chart{display:block;width:100%;height:auto}"
      ".chart text{font-size:13px;fill:currentColor}"
      ".chart path{fill:none;stroke-width:2;stroke-linecap:round;stroke-linejoin:round}"
      ".chart .grid{stroke:currentColor;stroke-width:1;opacity:.18}"
      ".chart .mark{stroke:currentColor;stroke-width:1.5;stroke-dasharray:5 4}\n";
  const auto add_colors = [&](const char* const(&colors)[kColors]) {
    for (int c = 0; c < kColors; ++c)
      style += fmt::format(".curve{0}{{stroke:{1}}}.bar{0}{{fill:{1}}}", c, colors[c]);
  };
  add_colors(kOnLight);
  style += "\n@media (prefers-color-scheme:dark){";
  add_colors(kOnDark);
  return style + "}\n";
}

}  // namespace planescope::report
