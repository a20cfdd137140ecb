#include "core/report/page/bar_chart.hpp"

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

constexpr double kGroupShare = 0.84;  // of a group's width that its bars take

std::string group_name(const std::string& name, double middle) {
  std::string svg;
  int y = kHeight - kBottom + 18;
  for (std::size_t begin = 0; begin <= name.size(); y += 16) {
    const std::size_t end = std::min(name.find('\n', begin), name.size());
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", middle, y,
                       html_escape(name.substr(begin, end - begin)));
    begin = end + 1;
  }
  return svg;
}

}  // namespace

std::string bar_chart(const BarChart& chart) {
  assert(!chart.groups.empty() && !chart.bars.empty());
  const Axis y = axis_over(chart.low, chart.high);
  std::string svg = begin_svg(chart.title) + y_grid(y);
  const double group_px =
      static_cast<double>(kWidth - kLeft - kRight) / static_cast<double>(chart.groups.size());
  const double bar_px = kGroupShare * group_px / static_cast<double>(chart.bars.size());
  for (std::size_t b = 0; b < chart.bars.size(); ++b) {
    const Curve& bar = chart.bars[b];
    assert(bar.values.size() == chart.groups.size());
    for (std::size_t g = 0; g < chart.groups.size(); ++g) {
      if (std::isnan(bar.values[g])) continue;
      const double left = kLeft + (static_cast<double>(g) + (1 - kGroupShare) / 2) * group_px +
                          static_cast<double>(b) * bar_px;
      const double top = y_of(y, std::clamp(bar.values[g], y.low, y.high));
      std::string where = chart.groups[g];
      std::replace(where.begin(), where.end(), '\n', ' ');
      svg += fmt::format(
          "<rect class=\"bar{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\">"
          "<title>{}, {}: {:.2f}</title></rect>\n",
          color_of(bar, b), left, top, std::max(bar_px - 1, 0.5), y_of(y, y.low) - top,
          html_escape(bar.name), html_escape(where), bar.values[g]);
    }
    const int legend_x = kWidth - kRight + 16, legend_y = kTop + 20 * static_cast<int>(b);
    svg += fmt::format(
        "<rect class=\"bar{}\" x=\"{}\" y=\"{}\" width=\"12\" height=\"12\"/>"
        "<text x=\"{}\" y=\"{}\">{}</text>\n",
        color_of(bar, b), legend_x, legend_y, legend_x + 20, legend_y + 11, html_escape(bar.name));
  }
  for (std::size_t g = 0; g < chart.groups.size(); ++g)
    svg += group_name(chart.groups[g], kLeft + (static_cast<double>(g) + 0.5) * group_px);
  return svg + "</svg>\n";
}

}  // namespace planescope::report
