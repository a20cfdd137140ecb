#pragma once

// Stairs, kerbs and ramps in planes.json. Internal to core/report.

#include <nlohmann/json_fwd.hpp>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::report {

/// floor, flights, kerbs, ramps and no_steps.
void add_stairs(const planes::Stairs& stairs, nlohmann::ordered_json& json);

}  // namespace planescope::report
