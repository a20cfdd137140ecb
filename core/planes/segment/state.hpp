#pragma once

// The segmentation in progress: what its stages read, and the only functions that change points,
// planes and nodes. Internal to core/planes/segment and to what replays and explains it.

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
  std::vector<GrowingPlane> planes = {};    // in order of founding
  std::vector<std::uint32_t> leftovers = {};  // Morton positions, in the order they were left over
  SegmentCounts counts = {};

  Vec3d point(std::uint32_t i) const { return octree.points[i].cast<double>(); }
  /// Is the point at Morton position i an inlier of a candidate with this label?
  bool has_label(std::uint32_t i, Label label) const {
    return !options.use_labels || octree.labels[i] == label;
  }
  std::int32_t input_index(std::uint32_t i) const {
    return static_cast<std::int32_t>(octree.order[i]);
  }
};

/// Builds the octree, in the cube where the options want it.
SegmentState start_segmentation(std::span<const Vec3f> points,
                                std::span<const Label> labels,
                                const Cube& cube,
                                const Vec3d& sensor,
                                const SegmentOptions& options,
                                Trace* trace);

/// A decision. Log it before what follows from it.
inline void log(const SegmentState& state, const TraceEvent& event) {
  if (state.trace) state.trace->events.push_back(event);
}

// The only functions that change where points are, what planes are and how far nodes have come.
// With a trace, each appends its change.

/// Takes a node from the queue; settles it; puts its children at the queue's end.
void visit_node(SegmentState& state, std::int32_t node);
void settle_node(SegmentState& state, std::int32_t node, Case decided);
void divide_node(SegmentState& state, std::int32_t node);

/// The point at Morton position i goes to the plane, out of where it was.
inline void give_point(SegmentState& state, std::uint32_t i, std::int32_t plane) {
  state.plane_of[i] = plane;
  if (state.trace) state.trace->points.push_back({i, {state.trace->steps(), plane, false}});
}
/// The point goes to the leftovers.
inline void leave_point(SegmentState& state, std::uint32_t i) {
  state.plane_of[i] = -1;
  state.leftovers.push_back(i);
  if (state.trace) state.trace->points.push_back({i, {state.trace->steps(), -1, true}});
}

/// The plane's number: the event that founds it is logged before.
std::int32_t found_plane(SegmentState& state, const GrowingPlane& plane);
/// Fits the plane to what the moments are of.
void fit_again(SegmentState& state, std::int32_t plane, const Moments& moments);
/// Eqs. (8)-(11): moments add, and the fit follows from them; no point is touched again.
template <typename PlaneOrCandidate>
void grow_plane(SegmentState& state, std::int32_t plane, const PlaneOrCandidate& part) {
  Moments moments = state.planes[plane].moments;
  fit_again(state, plane, moments += part.moments);
}
/// The plane ends: merged `into` another, or dropped. Its points must be given away as well.
void end_plane(SegmentState& state, std::int32_t plane, std::int32_t into = -1);
/// The plane goes into another, with its points.
void join_planes(SegmentState& state,
                 std::int32_t plane,
                 std::int32_t into,
                 std::span<const std::uint32_t> points);
/// Drops a plane and leaves its points over.
void drop_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points);

Moments moments_of(const SegmentState& state, std::span<const std::uint32_t> points);
/// Points of a plane found one of their own, with the plane's label; the plane is not fitted again.
std::int32_t found_part(SegmentState& state,
                        Stage stage,
                        std::int32_t plane,
                        std::span<const std::uint32_t> points);

/// Points of each plane, ascending Morton positions, as CSR.
struct PlanePoints {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> points;
  std::span<const std::uint32_t> of(std::int32_t plane) const {
    return {points.data() + first[plane], points.data() + first[plane + 1]};
  }
};
PlanePoints points_by_plane(const SegmentState& state);

/// Breadth-first traversal (Sec. IV-C): settles every node and fills the leftovers. By the
/// objective, each case IV node founds a plane; otherwise candidates are merged as they come.
void traverse(SegmentState& state);

/// Lets the candidate found a plane, with its points. `stage`: what decided it.
void found(SegmentState& state, const Candidate& candidate, Stage stage);
/// Sec. IV-C, Criterion 4: merges the candidate into the plane of its choice, or founds one.
void conquer(SegmentState& state, const Candidate& candidate);

/// Sec. IV-C, last paragraph: gives the leftovers to planes.
void assign_leftovers(SegmentState& state);

// How the paper's method chooses among planes. The stages pass no visitor. To explain a choice, it
// is made again with a visitor, which sees each pair in the order in which pairs were compared.

/// A candidate compared with a plane (Criterion 4).
struct Pair {
  std::int32_t plane = -1;
  Coplanarity terms;
  bool coplanar = false;
};
using PairVisitor = std::function<void(const Pair&)>;
/// The one that comes nearest to passing, of equals the first; null without any.
const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options);

/// The plane that the candidate joins, -1 if it founds one: the first coplanar one of the list or
/// the one with the least offset, as the options ask.
std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor = nullptr);

/// A point compared with a plane.
struct PointTerms {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;
  bool passes() const { return distance_m <= limit_m; }
};
using PointVisitor = std::function<void(const PointTerms&)>;

/// `plane` -1: none. `distance_m` is that from the plane or, without one, from the nearest; -1
/// where there is none.
struct PlaneChoice {
  std::int32_t plane = -1;
  double distance_m = -1;
};
/// The first plane of the list within leftover_distance_m of the point.
PlaneChoice choose_plane(const SegmentState& state,
                         std::uint32_t i,
                         const PointVisitor* visitor = nullptr);

}  // namespace planescope::planes
