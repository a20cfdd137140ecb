// Line and scatter charts as SVG, with round ticks and a shared style.

#include "core/report/page/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <limits>
#include <span>

namespace planescope::report {
namespace {

using kainjow::mustache::html_escape;

constexpr int kWidth = 760, kHeight = 320;
constexpr int kLeft = 52, kRight = 176, kTop = 14, kBottom = 44;  // margins
constexpr int kColors = 10;                                       // .curve0 ... in the style

struct Axis {
  double low = 0, high = 1;
  std::vector<double> ticks;

  double share(double value) const { return (value - low) / (high - low); }  // 0 at low, 1 at high
};

/// At most six round ticks: 1, 2 or 5 times a power of ten apart.
Axis axis_over(double low, double high) {
  const double span = std::max({high - low, 1e-6 * std::abs(high), 1e-9});
  const double power = std::pow(10, std::floor(std::log10(span / 5)));
  double step = power;
  for (const double factor : {1, 2, 5, 10}) {
    step = factor * power;
    if (span <= 5 * step) break;
  }
  Axis axis;
  axis.low = std::floor(low / step) * step;
  axis.high = std::max(std::ceil(high / step) * step, axis.low + step);
  const auto count = std::lround((axis.high - axis.low) / step) + 1;
  for (long i = 0; i < count; ++i) axis.ticks.push_back(axis.low + static_cast<double>(i) * step);
  return axis;
}

/// [px]
double y_of(const Axis& axis, double value) {
  return kHeight - kBottom - axis.share(value) * (kHeight - kTop - kBottom);
}

/// Lines across the plot at the ticks, and their values.
std::string y_grid(const Axis& axis) {
  std::string svg;
  for (const double tick : axis.ticks)
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>"
        "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>\n",
        kLeft, y_of(axis, tick), kWidth - kRight, kLeft - 8, y_of(axis, tick) + 4, tick);
  return svg;
}

/// Start of the SVG element, which ends with "</svg>\n".
std::string begin_svg(const std::string& title) {
  return fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                     kWidth, kHeight, html_escape(title));
}

/// Lowest and highest value, ignoring NaN; 0 and 1 if there are none.
struct Range {
  double low = 0, high = 1;
};
Range range_of(std::span<const Curve> curves) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Range range{kNone, kNone};
  for (const Curve& curve : curves)
    for (const double value : curve.values) {
      range.low = std::fmin(range.low, value);
      range.high = std::fmax(range.high, value);
    }
  return std::isnan(range.low) ? Range{} : range;
}

constexpr std::size_t kMostDots = 60;  // with more points, the line alone is clearer

double x_of(const Axis& axis, double value) {
  return kLeft + axis.share(value) * (kWidth - kLeft - kRight);
}

bool is_whole(double value) { return std::abs(value - std::round(value)) < 1e-9; }

/// `counts`: no ticks between whole numbers.
std::string x_ticks(const Axis& axis, const std::string& x_name, bool counts) {
  std::string svg;
  for (const double tick : axis.ticks) {
    if (counts && !is_whole(tick)) continue;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.6g}</text>\n",
                       x_of(axis, tick), kHeight - kBottom + 18, tick);
  }
  return svg + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                           (kLeft + kWidth - kRight) / 2, kHeight - 6, html_escape(x_name));
}

std::string mark(const LineChart& chart, const Axis& axis) {
  if (!chart.x_mark || *chart.x_mark > axis.high) return "";
  const double x = x_of(axis, *chart.x_mark);
  return fmt::format(
      "<path class=\"mark\" d=\"M{0:.1f} {1}V{2}\"/>"
      "<text x=\"{3:.1f}\" y=\"{4}\">{5}</text>\n",
      x, kTop, kHeight - kBottom, x + 6, kHeight - kBottom - 8, html_escape(chart.mark_name));
}

/// Path data through the values, skipping NaN. The first point is repeated, so that a curve of one
/// point shows as a dot.
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
  const Range range = range_of(chart.curves);
  const Axis y = axis_over(chart.from_zero ? std::fmin(0, range.low) : range.low, range.high);
  std::string svg = begin_svg(chart.title) + y_grid(y) +
                    x_ticks(x, chart.x_name, std::ranges::all_of(chart.x, is_whole)) +
                    mark(chart, x);
  for (std::size_t c = 0; c < chart.curves.size(); ++c) {
    const Curve& curve = chart.curves[c];
    assert(curve.values.size() == chart.x.size());
    const int color = (curve.color >= 0 ? curve.color : static_cast<int>(c)) % kColors;
    const int legend_x = kWidth - kRight + 16, legend_y = kTop + 8 + 20 * static_cast<int>(c);
    for (std::size_t i = 0; i < chart.x.size() && chart.x.size() <= kMostDots; ++i)
      if (!std::isnan(curve.values[i]))
        svg += fmt::format("<circle class=\"bar{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n",
                           color, x_of(x, chart.x[i]), y_of(y, curve.values[i]));
    svg += fmt::format(
        "<path class=\"curve{}\" d=\"{}M{} {}h16\"/><text x=\"{}\" y=\"{}\">{}</text>\n", color,
        path_of(chart, curve, x, y), legend_x, legend_y, legend_x + 24, legend_y + 4,
        html_escape(curve.name));
  }
  return svg + "</svg>\n";
}

std::string scatter_chart(const ScatterChart& chart) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Range across{kNone, kNone}, up{kNone, kNone};
  for (const Scatter& group : chart.groups)
    for (const auto& [x, y] : group.points) {
      across = {std::fmin(across.low, x), std::fmax(across.high, x)};
      up = {std::fmin(up.low, y), std::fmax(up.high, y)};
    }
  assert(!std::isnan(up.low));
  const Axis x = axis_over(across.low, across.high), y = axis_over(up.low, up.high);
  std::string svg = begin_svg(chart.title) + y_grid(y) + x_ticks(x, chart.x_name, false);
  for (std::size_t g = 0; g < chart.groups.size(); ++g) {
    const Scatter& group = chart.groups[g];
    std::string path;
    for (const auto& [px, py] : group.points) {
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_of(x, px), y_of(y, py));
      svg += fmt::format("<circle class=\"bar{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n",
                         group.color, x_of(x, px), y_of(y, py), group.radius_px);
    }
    if (group.joined) svg += fmt::format("<path class=\"curve{}\" d=\"{}\"/>\n", group.color, path);
    const int legend_x = kWidth - kRight + 24, legend_y = kTop + 8 + 20 * static_cast<int>(g);
    svg += fmt::format(
        "<circle class=\"bar{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
        group.color, legend_x, legend_y, group.radius_px, legend_x + 16, legend_y + 4,
        html_escape(group.name));
  }
  return svg + "</svg>\n";
}

std::string line_chart_style() {
  // Colors that are distinct with all kinds of color vision (Okabe and Ito), lighter on dark pages.
  // The last three are for charts with more than seven curves.
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

namespace {

constexpr const char* kPlainStyle =
    ":root{color-scheme:light dark;--page:#f7f7f5;--ink:#1d2127;--soft:#5a626d;--line:#e2e3e1}\n"
    "@media (prefers-color-scheme:dark){"
    ":root{--page:#131519;--ink:#e5e7ea;--soft:#9aa2ad;--line:#2c3037}}\n"
    "body{margin:2.5rem auto;max-width:56rem;padding:0 1.5rem;background:var(--page);"
    "color:var(--ink);font:15px/1.55 system-ui,sans-serif;font-variant-numeric:tabular-nums}\n"
    "h1{font-size:1.7rem;line-height:1.2;overflow-wrap:anywhere}h2{font-size:1.2rem;margin:2rem 0 "
    ".6rem}\n"
    "dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.2rem 1.4rem}"
    "dt,.soft{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}\n"
    ".wide{overflow-x:auto}table{border-collapse:collapse;width:100%}"
    "td,th{padding:.2rem .6rem;text-align:right;border-bottom:1px solid var(--line)}"
    "th{font-weight:600;vertical-align:bottom}\n";

}  // namespace

std::string plain_page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>{0}</title>\n<style>\n{1}{2}</style></head><body>\n<h1>{0}</h1>\n{3}"
      "</body></html>\n",
      html_escape(title), kPlainStyle, line_chart_style(), body);
}

}  // namespace planescope::report
