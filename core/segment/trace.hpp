#pragma once

#include <cstdint>
#include <vector>

namespace planescope {

enum class EventType : std::uint8_t {
  visit,   // node dequeued
  decide,  // node settled: value = e_n where computed
  found,   // node's candidate founds a new plane
  merge,   // node's candidate joins `plane`; value = |n . dmu| [m]
  assign,  // leftover `point` goes to `plane`; value = distance [m]
  drop,    // leftover `point` stays without a plane
  refine,  // a refinement changed `plane` (`other`: the plane it went into) or `point`
};

/// One decision, fixed size. Features are recomputed by whoever shows them; -1 where not
/// applicable.
struct TraceEvent {
  EventType type = EventType::visit;
  std::uint8_t node_case = 0;   // Case for `decide`
  std::uint8_t refinement = 0;  // 1..7 for `refine` and for what R1..R7 decided
  std::int32_t node = -1;
  std::int32_t plane = -1;  // index of the candidate plane, in order of founding
  std::int32_t other = -1;
  std::int32_t point = -1;  // index into the points given to segment()
  float value = 0;
};

struct Trace {
  std::vector<TraceEvent> events;
};

}  // namespace planescope
