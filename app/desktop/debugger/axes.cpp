#include "app/desktop/debugger/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

/// Bins grow by ratio on a logarithmic axis, but for the part of the first one below its edge.
bool by_ratio(const debug::Histogram& histogram, const debug::HistogramBin& bin) {
  return histogram.logarithmic && bin.low > 0;
}

}  // namespace

double SliderScale::share(double value) const {
  const double share = logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low)
                                   : (value - low) / (high - low);
  return std::clamp(share, 0.0, 1.0);
}

double SliderScale::value(double share) const {
  const double value = logarithmic ? low * std::pow(high / low, share) : low + share * (high - low);
  // Three digits: what a hand can mean.
  if (value == 0) return 0;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
  return std::round(value / unit) * unit;
}

SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile) {
  SliderScale scale;
  scale.standard = parse_number(planes::default_value(info, profile), "option " + info.name);
  const double base = scale.standard > 0                       ? scale.standard
                      : info.kind == planes::OptionKind::whole ? 10
                                                               : 0.02;
  const bool of_size = info.unit == "m" || info.unit == "m2";
  if (info.range.max <= 90 && !of_size) {  // shares, angles, levels: all of it
    scale.low = info.range.min;
    scale.high = info.range.max;
  } else if (info.kind == planes::OptionKind::whole) {
    scale.low = info.range.min;
    scale.high = 6 * base;
  } else if (scale.standard > 0) {
    scale.logarithmic = true;
    scale.low = std::max(info.range.min, base / 20);
    scale.high = std::min(info.range.max, base * 20);
  } else {  // 0 says "off": a linear scale can reach it
    scale.high = std::min(info.range.max, 5 * base);
  }
  return scale;
}

double HistogramAxis::share(double value) const {
  const auto& bins = histogram_.bins;
  const auto at = std::find_if(bins.begin(), bins.end(),
                               [&](const debug::HistogramBin& bin) { return value < bin.high; });
  if (at == bins.end()) return 1;
  if (value <= at->low)
    return at == bins.begin()
               ? 0
               : static_cast<double>(at - bins.begin()) / static_cast<double>(bins.size());
  const double inside = by_ratio(histogram_, *at)
                            ? std::log(value / at->low) / std::log(at->high / at->low)
                            : (value - at->low) / (at->high - at->low);
  return (static_cast<double>(at - bins.begin()) + inside) / static_cast<double>(bins.size());
}

double HistogramAxis::value(double share) const {
  const auto& bins = histogram_.bins;
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(bins.size());
  const std::size_t i = std::min(bins.size() - 1, static_cast<std::size_t>(position));
  const double inside = position - static_cast<double>(i);
  const debug::HistogramBin& bin = bins[i];
  return by_ratio(histogram_, bin) ? bin.low * std::pow(bin.high / bin.low, inside)
                                   : bin.low + inside * (bin.high - bin.low);
}

std::vector<double> axis_ticks(const debug::Histogram& histogram) {
  const auto& bins = histogram.bins;
  if (bins.empty()) return {};
  // The last bin takes what lies far out: its end says little.
  const double low = bins.front().low, high = bins.back().low;
  std::vector<double> ticks;
  if (histogram.logarithmic) {
    const double least = std::max(low, bins.front().high / 10);
    if (low <= 0) ticks.push_back(low);
    for (int power = static_cast<int>(std::floor(std::log10(least))); power < 12; ++power)
      if (const double tick = std::pow(10, power); tick >= least && tick <= high)
        ticks.push_back(tick);
  } else if (high > low) {
    const double rough = (high - low) / 4, unit = std::pow(10, std::floor(std::log10(rough)));
    const double step = rough / unit > 5 ? 10 * unit : rough / unit > 2 ? 5 * unit : 2 * unit;
    for (double k = std::ceil(low / step); k * step <= high; ++k) ticks.push_back(k * step);
  }
  return ticks.size() >= 2 ? ticks : std::vector<double>{low, bins.back().high};
}

std::string filter_between(const debug::Histogram& histogram, double from, double to) {
  if (histogram.quantity.empty()) return {};
  const HistogramAxis axis(histogram);
  const double low = axis.value(std::min(from, to)), high = axis.value(std::max(from, to));
  if (histogram.unit == "points")  // whole numbers
    return fmt::format("{0}>={1:.0f} && {0}<{2:.0f}", histogram.quantity, std::floor(low),
                       std::ceil(high));
  return fmt::format("{0}>={1:.3g} && {0}<{2:.3g}", histogram.quantity, low, high);
}

}  // namespace planescope::desktop
