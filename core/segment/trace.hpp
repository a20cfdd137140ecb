#pragma once

#include <cstdint>
#include <vector>

#include "core/classify/classifier.hpp"
#include "core/geometry/moments.hpp"

namespace planescope {

enum class EventType : std::uint8_t {
  visit,   // node dequeued
  decide,  // node settled: value = e_n where computed
  found,   // node's candidate founds a new plane; without a node: a part that splits off `other`
  merge,   // node's candidate joins `plane`; value = |n . dmu| [m]
  assign,  // leftover `point` goes to `plane`; value = distance [m]
  drop,    // leftover `point` stays without a plane
  refine,  // a refinement changed `plane` (`other`: the plane it went into) or `point`
  wait,    // R3: node's candidate waits for the sure ones; value = sigma_ang [rad]
  leave,   // points go back to the leftovers: R3's, node's candidate with value = sigma_ang [rad],
           // or all that are left of `plane`, a part too small after the split
};

/// TraceEvent::refinement of what split_disconnected did.
inline constexpr std::uint8_t kSplit = 8;

/// One decision, fixed size, logged before anything that follows from it. Features are recomputed
/// by whoever shows them; -1 where not applicable.
struct TraceEvent {
  EventType type = EventType::visit;
  std::uint8_t node_case = 0;    // Case for `decide`
  std::uint8_t refinement = 0;   // 1..7 for `refine` and for what R1..R7 decided, or kSplit
  Label label = Label::unknown;  // of the candidate: R4 makes two of one node
  std::int32_t node = -1;
  std::int32_t plane = -1;  // index of the candidate plane, in order of founding
  std::int32_t other = -1;
  std::int32_t point = -1;  // index into the points given to segment()
  float value = 0;
};

/// Values over their limits: up to 1 they pass. For histograms.
struct Strains {
  std::vector<float> planarity;  // Criterion 3, each time it was asked
  /// Criterion 4, or R1 in its place: of a candidate and the plane that it joined or, where it
  /// founded one, that it came nearest to joining.
  std::vector<float> angle, distance;
};

struct Trace {
  std::vector<TraceEvent> events;
  Strains strains;
  /// What planes were fitted to anew, per `refine` event of R6 and of the split, in their order:
  /// the points that R6 leaves out are not among the events.
  std::vector<Moments> refits;
  /// The points of each part that split off, per `found` event of the split, in their order.
  std::vector<std::vector<std::uint32_t>> parts;  // Morton order
};

}  // namespace planescope
