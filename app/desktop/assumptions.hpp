#pragma once

// What the program had to assume about a recording, each with the action that checks or settles it.

#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

struct Assumption {
  std::string text;    // "53 % beyond 1.5 m"
  std::string button;  // "show 4 m"
  std::string why;     // for the tooltip: one sentence
  std::string action, argument;
};

/// Assumptions about the current frame; empty before its first run and once dismissed.
std::vector<Assumption> assumptions_of(const State& state);

}  // namespace planescope::desktop
