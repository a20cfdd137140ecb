#pragma once

// Trace of a segmentation: its decisions and their effects, step by step; and the stages that
// decide, both the paper's and those of the objective of `refined`.

#include <cstdint>
#include <limits>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

enum class Stage : std::uint8_t {
  criteria,  // Criteria 1-3, in the traversal
  merge,     // Criterion 4
  assign,    // leftovers are assigned to planes
  join,      // objective: two regions that touch
  grow,      // pixels or points change regions
  hidden,    // two parts separated by an occlusion
  parts,     // a plane is split into disconnected parts
  list,      // planes not worth their cost are dropped
};

/// Description of an objective's stage, used wherever its decisions are shown.
struct StageInfo {
  const char* title;  // "merge neighbors"
  /// Text of its `refine` event; {plane}, {other}, {point} and the event's {value} (or {mm}, the
  /// value as a length) are replaced (fmt).
  const char* event_text = "{plane} changes";
  /// Reason for dropping a plane, if it needs one; same placeholders.
  const char* why_dropped = "";
  /// Relation between a part that becomes a new plane and the rest of the old plane.
  const char* why_parted = "";
  bool on_pixels = false;  // does nothing without a depth image
};

/// "criteria", "merge", "assign", "join" ... "list".
const char* to_string(Stage stage);
/// Null for the paper's stages.
const StageInfo* info_of(Stage stage);
/// All stages in order.
const std::vector<Stage>& stages();

enum class EventType : std::uint8_t {
  visit,   // node dequeued
  decide,  // node settled: value = e_n if computed
  found,   // node's candidate creates a plane; without a node: a part splits off `other`
  merge,   // node's candidate joins `plane`; value = |n . dmu| [m]
  assign,  // leftover `point` is assigned to `plane`; value = distance [m]
  drop,    // leftover `point` stays without a plane
  refine,  // a stage of the objective changed `plane` (`other`: the plane it was merged into)
};

/// One decision of fixed size, logged before its effects. Consumers recompute features. -1:
/// not applicable.
struct TraceEvent {
  EventType type = EventType::visit;
  std::uint8_t node_case = 0;  // Case for `decide`
  Stage stage = Stage::criteria;
  Label label = Label::unknown;  // label of the candidate; an impure node can have two
  std::int32_t node = -1;
  std::int32_t plane = -1;  // index of the candidate plane, in order of creation
  std::int32_t other = -1;
  std::int32_t point = -1;  // index into the points given to segment()
  float value = 0;
};

/// A plane under construction: moments, so that joining two planes needs no access to points.
struct GrowingPlane {
  Label label = Label::h;
  Moments moments;  // of the fitted points
  PlaneFit fit;
  bool alive = true;       // false: merged into another or pruned
  std::int32_t into = -1;  // if not alive: the plane it was merged into, -1 if dropped
};

// Step k is the state after the first k events. A change belongs to the last logged event, and
// takes effect at that event's step.
inline constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();

/// Assignment of a point from a step onward.
struct PointChange {
  std::int32_t step = 0;
  std::int32_t plane = -1;  // plane of the trace; -1 none
  bool leftover = false;    // in the list of leftovers
};

/// State of a plane from a step onward.
struct PlaneChange : GrowingPlane {
  std::int32_t step = 0;
};

/// Values relative to their limits (up to 1 passes), for histograms.
struct LimitRatios {
  std::vector<float> planarity;  // Criterion 3, every evaluation
  /// Criterion 4: for a candidate and the plane it joined or, if it created one, the plane it came
  /// closest to joining.
  std::vector<float> angle, distance;
};

/// Cost of treating a cell as one plane if a cell within it is not flat.
inline constexpr double kNotFlat = 1e30;

/// Values of Criteria 1-3 for a node of a depth image's octree; -1 if not evaluated.
struct ImageTerms {
  float filled = -1;      // Criterion 2, evaluated first: share of the cell's pixels in the cell
  float two_planes = -1;  // Criterion 1: cost of treating it, or a cell within it, as one plane
  float variance = -1;    // Criterion 3: variance relative to the expected
};

struct Trace {
  std::vector<TraceEvent> events;
  std::vector<ImageTerms> image_terms;  // per node; empty for 3D octrees

  // All changes, in step order.
  std::vector<std::int32_t> queued_at, visited_at, decided_at;  // per node, first step
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

  LimitRatios limit_ratios;

  std::int32_t steps() const { return static_cast<std::int32_t>(events.size()); }
};

}  // namespace planescope::planes
