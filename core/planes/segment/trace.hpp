#pragma once

// What the segmentation decided and what followed from it, step by step; and who decides: the
// stages of the paper, and those of the objective that `refined` minimizes.

#include <cstdint>
#include <limits>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

enum class Stage : std::uint8_t {
  criteria,  // Criteria 1-3, in the traversal
  merge,     // Criterion 4
  assign,    // leftovers go to planes
  join,      // by the objective: two regions that touch
  grow,      // pixels or points change hands
  hidden,    // two parts that something hides from each other
  parts,     // a plane falls into parts that do not touch
  list,      // what is worth being a plane
};

/// What a stage of the objective says of itself, wherever a decision is shown.
struct StageInfo {
  const char* title;  // "merge neighbors"
  /// What its `refine` event means, with {plane}, {other}, {point}, and the event's {value}, or as
  /// a length in {mm}, filled in (fmt).
  const char* says = "{plane} changes";
  /// Why a plane that it drops is none, where that needs saying; filled in likewise.
  const char* why_dropped = "";
  /// How a part that becomes a plane of its own and the rest of the old plane are related.
  const char* why_parted = "";
  bool on_pixels = false;  // does nothing where there is no depth image
};

/// "criteria", "merge", "assign", "join" ... "list".
const char* to_string(Stage stage);
/// Null for a stage of the paper.
const StageInfo* info_of(Stage stage);
/// All of them, in their order.
const std::vector<Stage>& stages();

enum class EventType : std::uint8_t {
  visit,   // node dequeued
  decide,  // node settled: value = e_n where computed
  found,   // node's candidate founds a new plane; without a node: a part that splits off `other`
  merge,   // node's candidate joins `plane`; value = |n . dmu| [m]
  assign,  // leftover `point` goes to `plane`; value = distance [m]
  drop,    // leftover `point` stays without a plane
  refine,  // a stage of the objective changed `plane` (`other`: the plane it went into)
};

/// One decision, fixed size, logged before anything that follows from it. Features are recomputed
/// by whoever shows them; -1 where not applicable.
struct TraceEvent {
  EventType type = EventType::visit;
  std::uint8_t node_case = 0;  // Case for `decide`
  Stage stage = Stage::criteria;
  Label label = Label::unknown;  // the candidate's: an impure node can have two
  std::int32_t node = -1;
  std::int32_t plane = -1;  // index of the candidate plane, in order of founding
  std::int32_t other = -1;
  std::int32_t point = -1;  // index into the points given to segment()
  float value = 0;
};

/// A plane while it is being put together: moments, so that joining two never touches points.
struct GrowingPlane {
  Label label = Label::h;
  Moments moments;  // of what it was fitted to
  PlaneFit fit;
  bool alive = true;       // false: merged into another or pruned
  std::int32_t into = -1;  // where not alive: the plane that it was merged into, -1 if dropped
};

// Step k is the state after the first k events. A change belongs to the event logged last: it holds
// from that event's step on.
inline constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();

/// A point's plane, or that it was left over, from a step on.
struct PointChange {
  std::int32_t step = 0;
  std::int32_t plane = -1;  // plane of the trace, -1 none
  bool leftover = false;    // on the list of leftovers
};

/// A plane from a step on.
struct PlaneChange : GrowingPlane {
  std::int32_t step = 0;
};

/// Values over their limits: up to 1 they pass. For histograms.
struct Strains {
  std::vector<float> planarity;  // Criterion 3, each time it was asked
  /// Criterion 4: of a candidate and the plane that it joined or, where it founded one, that it
  /// came nearest to joining.
  std::vector<float> angle, distance;
};

/// The cost of seeing a cell as one plane where a cell within it is not flat.
inline constexpr double kNotFlat = 1e30;

/// What Criteria 1-3 computed of a node of a depth image's octree; -1 where not asked.
struct ImageTerms {
  float filled = -1;      // Criterion 2, asked first: share of its pixels that it holds
  float two_planes = -1;  // Criterion 1: cost of seeing it, or a cell within it, as one plane
  float variance = -1;    // Criterion 3: relative to the expected
};

struct Trace {
  std::vector<TraceEvent> events;
  std::vector<ImageTerms> image_terms;  // per node; empty for an octree of space

  // All changes, in the order of their steps.
  std::vector<std::int32_t> queued_at, visited_at, decided_at;  // per node, from which step on
  struct Point {
    std::uint32_t point;  // Morton position
    PointChange change;
  };
  std::vector<Point> points;
  struct Plane {
    std::int32_t plane;
    PlaneChange change;
  };
  std::vector<Plane> planes;

  Strains strains;

  std::int32_t steps() const { return static_cast<std::int32_t>(events.size()); }
};

}  // namespace planescope::planes
