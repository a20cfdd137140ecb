#include "app/desktop/debugger/histogram_axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planescope::desktop {
namespace {

/// Bins grow by ratio on a logarithmic axis, but for the part of the first one below its edge.
bool by_ratio(const debug::Histogram& histogram, const debug::HistogramBin& bin) {
  return histogram.logarithmic && bin.low > 0;
}

}  // namespace

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
