#pragma once

// Where values stand on the axes of panels: sliders and histograms. Pure functions.

#include <cstdint>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {

// ---- Sliders -----------------------------------------------------------------------------------

/// From `low` to `high`, by ratio where logarithmic. Values of the option beyond these are typed.
struct SliderScale {
  double low = 0, high = 1;
  bool logarithmic = false;
  double standard = 0;  // the profile's default

  double share(double value) const;  // 0..1
  double value(double share) const;
};
/// Wide enough to hold the default a few times over, within the option's range.
SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile);

// ---- Histograms --------------------------------------------------------------------------------

/// Where values stand across a histogram that gives every bin the same width: the last bin takes
/// what lies far out, logarithmic bins take the decades.
class HistogramAxis {
 public:
  explicit HistogramAxis(const debug::Histogram& histogram) : histogram_(histogram) {}
  double share(double value) const;  // 0..1
  double value(double share) const;

 private:
  const debug::Histogram& histogram_;
};

/// Round values across the axis, ascending: 1, 2 and 5 times powers of ten, its ends' own where
/// that is fewer than two.
std::vector<double> axis_ticks(const debug::Histogram& histogram);

/// The filter for the values from one share to another; empty where the quantity is not in the
/// language.
std::string filter_between(const debug::Histogram& histogram, double from, double to);

}  // namespace planescope::desktop
