#pragma once

#include "core/debug/explain/histogram.hpp"

namespace planescope::desktop {

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

/// The filter for the values from one share to another; empty where the quantity is not in the
/// language.
std::string filter_between(const debug::Histogram& histogram, double from, double to);

}  // namespace planescope::desktop
