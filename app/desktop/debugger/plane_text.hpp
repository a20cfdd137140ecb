#pragma once

// What is told about a finished plane, and about what leads from one to another. Pure functions of
// the state; planes are the trace's.

#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// What is known of the run looked at and its plane's number in the result, from 1; 0 before the
/// last step, and of planes that did not stay.
int finished_plane(const State& state, std::int32_t plane);

/// "steppable", "not steppable: 17 mm rough, limit 10"; empty where that is not known.
std::string verdict_text(const State& state, std::int32_t plane);

/// "P1, 0.52 m2, slope 1.2 deg" and, in a second line, the verdict.
std::string describe_plane(const State& state, std::int32_t plane);

/// Area, slope, roughness, support, certainty, clearance, height; empty where none is known.
struct PlaneLine {
  std::string name, value, meaning;
};
std::vector<PlaneLine> plane_lines(const State& state, std::int32_t plane);

/// Of a level plane: why no step leads up to it, or from it.
std::vector<std::string> no_steps_of(const State& state, std::int32_t plane);

/// A flight, kerb or ramp: a line, further ones, and the planes that it leads over.
struct StairsEntry {
  std::string title;
  std::vector<std::string> lines;
  std::vector<std::int32_t> planes;  // of the trace
};
std::vector<StairsEntry> stairs_entries(const State& state);

}  // namespace planescope::desktop
