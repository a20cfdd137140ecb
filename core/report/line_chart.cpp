#include "core/report/line_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <kainjow/mustache.hpp>

namespace planescope {
namespace {

using kainjow::mustache::html_escape;

constexpr int kWidth = 760, kHeight = 320;
constexpr int kLeft = 52, kRight = 150, kTop = 14, kBottom = 44;  // margins
constexpr int kColors = 7;                                        // .curve0 ... of the style

struct Axis {
  double low = 0, high = 1, step = 1;

  int ticks() const { return static_cast<int>(std::lround((high - low) / step)) + 1; }
  double tick(int i) const { return low + i * step; }
  double share(double value) const { return (value - low) / (high - low); }
};

/// An axis over a range with at most six round ticks: 1, 2 or 5 times a power of ten apart.
Axis axis_over(double low, double high) {
  const double span = std::max({high - low, 1e-6 * std::abs(high), 1e-9});
  const double power = std::pow(10, std::floor(std::log10(span / 5)));
  Axis axis;
  for (const double factor : {1, 2, 5, 10}) {
    axis.step = factor * power;
    if (span <= 5 * axis.step) break;
  }
  axis.low = std::floor(low / axis.step) * axis.step;
  axis.high = std::max(std::ceil(high / axis.step) * axis.step, axis.low + axis.step);
  return axis;
}

double x_of(const Axis& axis, double value) {
  return kLeft + axis.share(value) * (kWidth - kLeft - kRight);
}
double y_of(const Axis& axis, double value) {
  return kHeight - kBottom - axis.share(value) * (kHeight - kTop - kBottom);
}

std::string grid(const Axis& x, const Axis& y, const std::string& x_name) {
  std::string svg;
  for (int i = 0; i < y.ticks(); ++i)
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>"
        "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>\n",
        kLeft, y_of(y, y.tick(i)), kWidth - kRight, kLeft - 8, y_of(y, y.tick(i)) + 4, y.tick(i));
  for (int i = 0; i < x.ticks(); ++i)
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.6g}</text>\n",
                       x_of(x, x.tick(i)), kHeight - kBottom + 18, x.tick(i));
  return svg + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                           (kLeft + kWidth - kRight) / 2, kHeight - 6, html_escape(x_name));
}

}  // namespace

std::string line_chart(const LineChart& chart) {
  assert(!chart.x.empty() && !chart.curves.empty());
  double low = chart.from_zero ? 0 : chart.curves[0].values[0], high = low;
  for (const Curve& curve : chart.curves) {
    assert(curve.values.size() == chart.x.size());
    low = std::min(low, *std::min_element(curve.values.begin(), curve.values.end()));
    high = std::max(high, *std::max_element(curve.values.begin(), curve.values.end()));
  }
  const Axis x = axis_over(0, chart.x.back());
  const Axis y = axis_over(low, high);
  std::string svg =
      fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                  kWidth, kHeight, html_escape(chart.title));
  svg += grid(x, y, chart.x_name);
  for (std::size_t c = 0; c < chart.curves.size(); ++c) {
    const Curve& curve = chart.curves[c];
    // To its first point twice: a curve of one point is a dot.
    std::string path = fmt::format("M{:.1f} {:.1f}", x_of(x, chart.x[0]), y_of(y, curve.values[0]));
    for (std::size_t i = 0; i < chart.x.size(); ++i)
      path += fmt::format("L{:.1f} {:.1f}", x_of(x, chart.x[i]), y_of(y, curve.values[i]));
    const int legend_x = kWidth - kRight + 16, legend_y = kTop + 8 + 20 * static_cast<int>(c);
    svg += fmt::format(
        "<path class=\"curve{}\" d=\"{}M{} {}h16\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
        c % kColors, path, legend_x, legend_y, legend_x + 24, legend_y + 4,
        html_escape(curve.name));
  }
  return svg + "</svg>\n";
}

std::string line_chart_style() {
  // Told apart by all kinds of colour vision (Okabe and Ito), on dark pages lighter.
  constexpr const char* kOnLight[kColors] = {"#0072b2", "#d55e00", "#009e73", "#b65c94",
                                             "#b98500", "#3f9fd0", "#555555"};
  constexpr const char* kOnDark[kColors] = {"#4ba3dd", "#f08a4b", "#2fc79a", "#e39cc4",
                                            "#e9b93d", "#8fd0f5", "#b0b0b0"};
  std::string style =
      ".chart{display:block;width:100%;height:auto}"
      ".chart text{font-size:13px;fill:currentColor}"
      ".chart path{fill:none;stroke-width:2;stroke-linecap:round;stroke-linejoin:round}"
      ".chart .grid{stroke:currentColor;stroke-width:1;opacity:.18}\n";
  for (int c = 0; c < kColors; ++c) style += fmt::format(".curve{}{{stroke:{}}}", c, kOnLight[c]);
  style += "\n@media (prefers-color-scheme:dark){";
  for (int c = 0; c < kColors; ++c) style += fmt::format(".curve{}{{stroke:{}}}", c, kOnDark[c]);
  return style + "}\n";
}

}  // namespace planescope
