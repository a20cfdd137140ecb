#pragma once

// What rules are about, and how each is taken from a frame. Internal to core/report/compare.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/report/compare/rules.hpp"

namespace planescope::report {

using FrameValue = std::optional<double> (*)(const FrameComparison&);

struct MeasuredMetric {
  RuleMetric metric;
  FrameValue value;  // nullopt where the frame has none
  // More than the value tells, of a frame that has one; null: nothing.
  std::string (*why)(const FrameComparison&) = nullptr;
  // Changes of undecided planes are not in `value`. The value with them; null: there is no such
  // difference. And which undecided planes changed: "plane 3 (margin 0.02)".
  FrameValue with_undecided = nullptr;
  std::string (*undecided)(const FrameComparison&) = nullptr;
};
const std::vector<MeasuredMetric>& measured_metrics();

/// `name` must be one of them.
const MeasuredMetric& find_metric(std::string_view name);

}  // namespace planescope::report
