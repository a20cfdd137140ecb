#pragma once

// What can be done with what the mouse points at. Pure functions of the state.

#include <string>
#include <vector>

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

struct ContextEntry {
  std::string name;  // of its widget: "context.<name>"
  std::string title;
  std::string key = {};  // of the action, where it is one alone
  std::vector<Command> commands;
};

/// What it is, in a line.
std::string context_title(const State& state, const PointedAt& at);
std::vector<ContextEntry> context_entries(const State& state, const PointedAt& at);

}  // namespace planescope::desktop
