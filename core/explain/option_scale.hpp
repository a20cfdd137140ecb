#pragma once

// How far a number is from another, so that changes of different options can be compared. Internal
// to core/explain.

#include "core/pipeline/options_table.hpp"

namespace planescope {

/// Positions on a logarithmic axis: log value or, for shares between 0 and 1, log of their odds,
/// since 0.98 is as far from 0.99 as 0.02 from 0.01. 0 itself stands at the far end.
class OptionScale {
 public:
  explicit OptionScale(const OptionInfo& info) : info_(info) {}
  double position(double value) const;
  /// The value there as --set takes it, within the option's range.
  std::string text_at(double position) const;

 private:
  bool is_share() const { return info_.range.min == 0 && info_.range.max == 1; }
  const OptionInfo& info_;
};

}  // namespace planescope
