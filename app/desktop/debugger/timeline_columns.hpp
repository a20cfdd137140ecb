#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

/// What the events under one column of the scrubber were.
struct TimelineColumn {
  std::array<std::uint32_t, 5> cases{};  // nodes settled, by Case
  std::uint32_t events = 0;
  std::uint32_t found = 0, merged = 0, assigned = 0, dropped = 0, refined = 0;
  std::int32_t plane = -1;  // that the last of them concerned

  std::uint32_t decided() const { return cases[1] + cases[2] + cases[3] + cases[4]; }
};

/// The events of a run spread over `count` columns. Step k stands at column_of_step(k).
std::vector<TimelineColumn> timeline_columns(const debug::Run& run, int count);
int column_of_step(std::int32_t step, std::int32_t steps, int count);

}  // namespace planescope::desktop
