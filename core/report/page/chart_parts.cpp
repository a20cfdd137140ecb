#include "core/report/page/chart_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <limits>

namespace planescope::report::chart {

double Axis::share(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  return std::log(std::max(value, low) / low) / std::log(high / low);
}

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

Axis log_axis_over(double low, double high) {
  Axis axis;
  axis.logarithmic = true;
  axis.low = low;
  axis.high = std::max(high, 1.5 * low);
  const bool few = axis.high / axis.low < 100;
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  const int last = static_cast<int>(std::floor(std::log10(axis.high)));
  for (int power = first; power <= last; ++power)
    for (const int factor : {1, 2, 5}) {
      const double tick = factor * std::pow(10, power);
      const bool inside = tick >= 0.999 * axis.low && tick <= 1.001 * axis.high;
      if (inside && (few || factor == 1)) axis.ticks.push_back(tick);
    }
  return axis;
}

double y_of(const Axis& axis, double value) {
  return kHeight - kBottom - axis.share(value) * (kHeight - kTop - kBottom);
}

std::string y_grid(const Axis& axis) {
  std::string svg;
  for (const double tick : axis.ticks)
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>"
        "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>\n",
        kLeft, y_of(axis, tick), kWidth - kRight, kLeft - 8, y_of(axis, tick) + 4, tick);
  return svg;
}

std::string begin_svg(const std::string& title) {
  return fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                     kWidth, kHeight, kainjow::mustache::html_escape(title));
}

int color_of(const Curve& curve, std::size_t place) {
  return (curve.color >= 0 ? curve.color : static_cast<int>(place)) % kColors;
}

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

}  // namespace planescope::report::chart
