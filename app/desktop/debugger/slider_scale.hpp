#pragma once

// Where a value stands on an option's slider, and which sliders there are.

#include "app/desktop/state/state.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {

/// From `low` to `high`, by ratio where logarithmic. What an option may take beyond is typed.
struct SliderScale {
  double low = 0, high = 1;
  bool logarithmic = false;
  double standard = 0;  // the profile's default

  double share(double value) const;  // 0..1
  double value(double share) const;
};
/// Wide enough to hold the default a few times over, inside what the option may take.
SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile);

/// The numbers of a group of options are folded away, but for those that are not their default.
bool is_folded(const State& state, const planes::OptionInfo& info);

}  // namespace planescope::desktop
