#pragma once

// The state in plain facts, for scripts that expect something and for whoever waits for the window.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// {"recording", "frame", "step", "steps", "event", "node", "case", "planes", "matches", ...}; what
/// docs/desktop.md lists.
nlohmann::ordered_json state_facts(const State& state, bool idle);
/// The same as text for a file. Bytes that are no UTF-8, of a path for instance, are replaced.
std::string state_text(const State& state, bool idle);

}  // namespace planescope::desktop
