#pragma once

// State of the segmentation in progress, and the only functions that change points, planes and
// nodes. Internal to core/planes/segment, replay and explanations.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/planes/segment/cells.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

struct SegmentState {
  const SegmentOptions& options;
  Vec3d sensor;
  Trace* trace = nullptr;
  Octree octree = {};
  NoiseModel noise = {};
  std::vector<std::int32_t> plane_of = {};  // per Morton-ordered point: index into planes, -1 none
  std::vector<GrowingPlane> planes = {};    // in order of creation
  std::vector<std::uint32_t> leftovers = {};  // Morton positions, in the order they were left over
  SegmentCounts counts = {};

  Vec3d point(std::uint32_t i) const { return octree.points[i].cast<double>(); }
  /// Whether the point at Morton position i is an inlier of a candidate with this label.
  bool has_label(std::uint32_t i, Label label) const {
    return !options.use_labels || octree.labels[i] == label;
  }
  std::int32_t input_index(std::uint32_t i) const {
    return static_cast<std::int32_t>(octree.order[i]);
  }
};

/// Builds the octree in the cube requested by the options.
SegmentState start_segmentation(std::span<const Vec3f> points,
                                std::span<const Label> labels,
                                const Cube& cube,
                                const Vec3d& sensor,
                                const SegmentOptions& options,
                                Trace* trace);

/// Logs a decision. Call before applying its consequences.
inline void log(const SegmentState& state, const TraceEvent& event) {
  if (state.trace) state.trace->events.push_back(event);
}

// The only functions that change points, planes and nodes. With a trace, each appends its change.

/// Removes a node from the queue; sets its case; appends its children to the queue.
void visit_node(SegmentState& state, std::int32_t node);
void settle_node(SegmentState& state, std::int32_t node, Case decided);
void divide_node(SegmentState& state, std::int32_t node);

/// Assigns the point at Morton position i to the plane, removing it from its previous plane.
inline void give_point(SegmentState& state, std::uint32_t i, std::int32_t plane) {
  state.plane_of[i] = plane;
  if (state.trace) state.trace->points.push_back({i, {state.trace->steps(), plane, false}});
}
/// Adds the point to the leftovers.
inline void leave_point(SegmentState& state, std::uint32_t i) {
  state.plane_of[i] = -1;
  state.leftovers.push_back(i);
  if (state.trace) state.trace->points.push_back({i, {state.trace->steps(), -1, true}});
}

/// Returns the plane's index. Log the event that creates it first.
std::int32_t found_plane(SegmentState& state, const GrowingPlane& plane);
/// Fits the plane to the points summed in `moments`.
void fit_again(SegmentState& state, std::int32_t plane, const Moments& moments);
/// Eqs. (8)-(11): adds moments and refits; no access to points.
template <typename PlaneOrCandidate>
void grow_plane(SegmentState& state, std::int32_t plane, const PlaneOrCandidate& part) {
  Moments moments = state.planes[plane].moments;
  fit_again(state, plane, moments += part.moments);
}
/// Ends the plane: merged `into` another plane, or dropped. The caller must reassign its points.
void end_plane(SegmentState& state, std::int32_t plane, std::int32_t into = -1);
/// Merges the plane and its points into another.
void join_planes(SegmentState& state,
                 std::int32_t plane,
                 std::int32_t into,
                 std::span<const std::uint32_t> points);
/// Drops a plane; its points become leftovers.
void drop_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points);

Moments moments_of(const SegmentState& state, std::span<const std::uint32_t> points);
/// Creates a plane from points of another plane, with the same label; the other is not refitted.
std::int32_t found_part(SegmentState& state,
                        Stage stage,
                        std::int32_t plane,
                        std::span<const std::uint32_t> points);

/// Points of each plane in CSR format, as ascending Morton positions.
struct PlanePoints {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> points;
  std::span<const std::uint32_t> of(std::int32_t plane) const {
    return {points.data() + first[plane], points.data() + first[plane + 1]};
  }
};
PlanePoints points_by_plane(const SegmentState& state);

/// Breadth-first traversal (Sec. IV-C): settles every node and collects the leftovers. With the
/// objective, each case IV node creates a plane; otherwise candidates are merged immediately.
void traverse(SegmentState& state);

/// Creates a plane from the candidate and its points. `stage`: the stage that decided it.
void found(SegmentState& state, const Candidate& candidate, Stage stage);
/// Sec. IV-C, Criterion 4: merges the candidate into the plane of choose_partner(), or creates one.
void conquer(SegmentState& state, const Candidate& candidate);

/// Sec. IV-C, last paragraph: assigns the leftovers to planes.
void assign_leftovers(SegmentState& state);

// Choices between planes in the paper's method. The stages pass no visitor. To explain a choice, it
// is repeated with a visitor, which is called for each compared pair in order.

/// Comparison of a candidate with a plane (Criterion 4).
struct Pair {
  std::int32_t plane = -1;
  Coplanarity terms;
  bool coplanar = false;
};
using PairVisitor = std::function<void(const Pair&)>;
/// The pair closest to passing, the first on ties; null if `pairs` is empty.
const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options);

/// The plane that the candidate joins, or -1 if it creates one: the first coplanar plane in the
/// list or the one with the smallest offset, depending on the options.
std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor = nullptr);

/// Comparison of a point with a plane.
struct PointTerms {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;
  bool passes() const { return distance_m <= limit_m; }
};
using PointVisitor = std::function<void(const PointTerms&)>;

/// `plane` -1: none. `distance_m`: distance from the plane or, without one, from the nearest plane;
/// -1 if there are no planes.
struct PlaneChoice {
  std::int32_t plane = -1;
  double distance_m = -1;
};
/// The first plane in the list within leftover_distance_m of the point.
PlaneChoice choose_plane(const SegmentState& state,
                         std::uint32_t i,
                         const PointVisitor* visitor = nullptr);

}  // namespace planescope::planes
