#pragma once

// What the metrics of rules are, and a frame's value of each.

#include <optional>

#include "core/report/rules/rules.hpp"

namespace planescope::report {

using FrameValue = std::optional<double> (*)(const FrameComparison&);

struct Metric {
  RuleMetric metric;
  FrameValue value;  // nullopt where the frame has none
};
const std::vector<Metric>& metrics();
/// Of one that is known.
const Metric& find_metric(std::string_view name);

}  // namespace planescope::report
