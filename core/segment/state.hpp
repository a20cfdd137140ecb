#pragma once

// What the stages of segment() hand to each other. Internal to core/segment.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/segment/candidate.hpp"
#include "core/segment/segment.hpp"

namespace planescope {

/// A plane while it is being put together: moments, so that joining two never touches points.
struct GrowingPlane {
  Label label = Label::h;
  Moments moments;
  PlaneFit fit;
  double sigma_ang = 0;  // [rad]
  Bounds bounds;
  bool alive = true;       // false: merged into another or pruned
  std::int32_t into = -1;  // the plane that R7 merged it into
};

/// Thrown by SegmentState::log() instead of logging event number `stop_at`.
struct Stopped {};

struct SegmentState {
  const SegmentOptions& options;
  const Vec3d& sensor;
  const Measurements& more;
  Trace* trace;
  Octree octree = {};
  NoiseModel noise = {};
  std::vector<std::int32_t> plane_of = {};  // per Morton-ordered point: index into planes, -1 none
  std::vector<GrowingPlane> planes = {};    // in order of founding
  std::vector<std::uint32_t> leftovers = {};  // Morton-order positions, in the order they were left
  std::vector<Candidate> weak = {};           // R3: wait until the strong ones are merged
  SegmentCounts counts = {};
  std::size_t stop_at = std::numeric_limits<std::size_t>::max();

  double range(const Vec3d& p) const { return (p - sensor).norm(); }
  double tau(const Vec3d& p) const { return noise.tau(range(p)); }
  /// A growing plane or a candidate, as distance_terms() takes it.
  template <typename PlaneOrCandidate>
  MeasuredPlane measured(const PlaneOrCandidate& p) const {
    return {p.fit, p.moments, p.sigma_ang, tau(p.fit.centroid), p.bounds};
  }
  /// Call it before changing what the event says: the state after k events is then the one in which
  /// a run stands that is stopped at the next.
  void log(TraceEvent event) const {
    if (!trace) return;
    if (trace->events.size() == stop_at) throw Stopped{};
    trace->events.push_back(event);
  }
  /// The same for a plane that is fitted anew.
  void log_refit(std::int32_t plane, const Moments& moments, std::uint8_t refinement) const {
    log({.type = EventType::refine, .refinement = refinement, .plane = plane});
    if (trace) trace->refits.push_back(moments);
  }
  std::int32_t input_index(std::uint32_t morton) const {
    return static_cast<std::int32_t>(octree.order[morton]);
  }
};

/// Builds the octree, in the cube where the options want it.
SegmentState start_segmentation(std::span<const Vec3f> points,
                                std::span<const Label> labels,
                                const Cube& cube,
                                const Vec3d& sensor,
                                const SegmentOptions& options,
                                Trace* trace,
                                const Measurements& more);

/// All stages after that, in their order.
void run_stages(SegmentState& state);

/// Points of each plane, ascending Morton positions, as CSR.
struct PlanePoints {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> points;
  std::span<const std::uint32_t> of(std::int32_t plane) const {
    return {points.data() + first[plane], points.data() + first[plane + 1]};
  }
};

PlanePoints points_by_plane(const SegmentState& state);

/// area_per_point() of the plane that the median point of all planes belongs to.
double typical_area_per_point(const SegmentState& state);

/// Is the point at Morton position i an inlier of a candidate with this label?
inline bool has_label(const SegmentState& state, std::uint32_t i, Label label) {
  return !state.options.use_labels || state.octree.labels[i] == label;
}

/// Breadth-first traversal (Sec. IV-C): settles every node, founds and merges planes, fills the
/// leftovers and the weak candidates.
void traverse(SegmentState& state);

/// Merges the candidate into a coplanar plane or lets it found one; its points follow.
void conquer(SegmentState& state, const Candidate& candidate);

/// Among `planes`, the one nearest to the point at Morton position i, within tau and with the
/// penalty for the other label; plane -1 if there is none.
struct NearestPlane {
  std::int32_t plane = -1;
  double distance_m = -1;
};
NearestPlane nearest_plane(const SegmentState& state,
                           std::span<const std::int32_t> planes,
                           std::uint32_t i);

/// R3, R7, R2, R6, R5 and R2 again after the traversal, around the assignment of leftovers.
void join_weak_candidates(SegmentState& state);
void merge_planes_again(SegmentState& state);
void prune_explained_planes(SegmentState& state);
/// Its points are left over.
void give_up_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points);
void assign_leftovers(SegmentState& state, std::size_t first = 0);  // of state.leftovers
void refit_planes(SegmentState& state);
void reassign_shared_points(SegmentState& state);
void drop_emptied_planes(SegmentState& state);
void split_disconnected_planes(SegmentState& state);

}  // namespace planescope
