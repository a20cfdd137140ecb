#include "app/desktop/debugger/slider_scale.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace planescope::desktop {

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
  if (info.range.max <= 90) {  // shares, angles, levels: all of it
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

bool is_folded(const State& state, const planes::OptionInfo& info) {
  if (info.group.empty() || !info.is_number() || state.view.unfolded.contains(info.group))
    return false;
  const planes::PipelineOptions& options = state.document.options;
  return info.get(options) == planes::default_value(info, options.segment.profile);
}

}  // namespace planescope::desktop
