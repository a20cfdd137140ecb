#pragma once

// The segmentation in progress: what its stages read, and the only functions that change points,
// planes and nodes. Internal to core/planes/segment and to what replays and explains it.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/planes/segment/cells.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/pixel_reach.hpp"
#include "core/planes/segment/pixel_runs.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

/// How far from a plane a point may lie to go to it, and by how much nearer a plane of the other
/// label must be: leftover_distance_m and nothing by the rule `first`, else tau and some sigma.
struct Reach {
  double limit_m = 0;
  double penalty_m = 0;
};

struct SegmentState {
  const SegmentOptions& options;
  Vec3d sensor;
  const Measurements& more;
  Trace* trace = nullptr;
  int threads = 1;
  Octree octree = {};
  NoiseModel noise = {};
  std::vector<std::int32_t> plane_of = {};  // per Morton-ordered point: index into planes, -1 none
  std::vector<GrowingPlane> planes = {};    // in order of founding
  std::vector<std::uint32_t> leftovers = {};  // Morton positions, in the order they were left over
  std::vector<Candidate> weak = {};           // R3: wait until the strong ones are merged
  std::vector<std::int32_t> plane_of_pixel = {};  // R11: per pixel, -1 none; without it empty
  std::vector<std::int32_t> minor = {};           // R10: planes that it dropped ...
  std::vector<std::vector<std::uint32_t>> minor_points = {};  // ... and what they had been given
  SegmentCounts counts = {};
  mutable std::shared_ptr<const CellGrid> cells = {};   // neighbour_cells(), once asked for
  mutable std::vector<Reach> reaches = {};              // likewise
  mutable std::vector<MeasuredRun> runs = {};           // likewise
  mutable PixelReach pixel_reach = {};                  // likewise
  mutable std::vector<std::int32_t> pixel_planes = {};  // planes_of_pixels(), when last asked for

  /// The grid of options.noise.neighbour_levels: where points are does not change.
  const CellGrid& neighbour_cells() const {
    if (!cells)
      cells = std::make_shared<CellGrid>(make_cell_grid(octree, options.noise.neighbour_levels));
    return *cells;
  }
  /// Of each point, by its tau: the noise is measured before the first is asked for.
  const Reach& reach(std::uint32_t i) const {
    if (reaches.empty()) measure_reaches();
    return reaches[i];
  }
  void measure_reaches() const;
  /// Of the depth image, by points in Morton order: which pixel went into which does not change.
  std::span<const MeasuredRun> pixel_runs() const {
    if (runs.empty()) runs = make_pixel_runs(more.pixels, octree.order);
    return runs;
  }
  /// R11's, by the measured noise.
  const PixelReach& reach_of_pixels() const {
    if (pixel_reach.tau_m.empty())
      pixel_reach = measure_pixel_reach(more.pixels, pixel_runs(), sensor, noise,
                                        options.r11_pixel_borders.reach_m);
    return pixel_reach;
  }
  Vec3d point(std::uint32_t i) const { return octree.points[i].cast<double>(); }
  double range(const Vec3d& p) const { return (p - sensor).norm(); }
  double tau(const Vec3d& p) const { return noise.tau(range(p)); }
  double sigma(const PlaneFit& fit) const { return noise.sigma(range(fit.centroid)); }
  /// How well the normal is known [rad].
  double sigma_ang(const PlaneFit& fit) const {
    return normal_uncertainty(fit, sigma(fit), options.noise.normal_sigma_share);
  }
  /// Is the point at Morton position i an inlier of a candidate with this label?
  bool has_label(std::uint32_t i, Label label) const {
    return !options.use_labels || octree.labels[i] == label;
  }
  /// As distance_terms() takes it.
  MeasuredPlane measured(const Candidate& p) const {
    return {p.fit, p.moments, p.sigma_ang, tau(p.fit.centroid), p.bounds};
  }
  static MeasuredPlane measured(const GrowingPlane& p) {
    return {p.fit, p.moments, p.sigma_ang, p.tau_m, p.bounds};
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
                                Trace* trace,
                                const Measurements& more);

/// fit_label() of a node, and how well its normal is known.
inline Candidate candidate_of(const SegmentState& state, std::int32_t node, Label label) {
  Candidate candidate = fit_label(state.octree, node, label, state.options.use_labels);
  candidate.sigma_ang = state.sigma_ang(candidate.fit);
  return candidate;
}

/// A decision. Log it before what follows from it.
inline void log(const SegmentState& state, const TraceEvent& event) {
  if (state.trace) state.trace->events.push_back(event);
}

/// What a refinement does to a plane as a whole: `other`, the one it goes into; `value`, by what.
template <typename Options>
void log_refine(const SegmentState& state,
                const Options& options,
                std::int32_t plane,
                std::int32_t other = -1,
                double value = 0) {
  log(state, {.type = EventType::refine,
              .stage = stage_of(options),
              .plane = plane,
              .other = other,
              .value = static_cast<float>(value)});
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
  state.planes[plane].bounds += part.bounds;
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

/// Per pixel of the depth image, the plane of its point, -1 none. Empty where there is no image.
/// Valid until asked for again.
std::span<const std::int32_t> planes_of_pixels(const SegmentState& state);

/// area_per_point() of the plane that the median point of all planes belongs to.
double typical_area_per_point(const SegmentState& state);

/// Breadth-first traversal (Sec. IV-C): settles every node, founds and merges planes, fills the
/// leftovers and the weak candidates.
void traverse(SegmentState& state);

/// Lets the candidate found a plane, or join one; its points follow. `stage`: what decided it.
void found(SegmentState& state, const Candidate& candidate, Stage stage);
void merge(SegmentState& state, const Candidate& candidate, std::int32_t plane, Stage stage);
/// Sec. IV-C, Criterion 4: merges the candidate into the plane of its choice, or founds one.
void conquer(SegmentState& state, const Candidate& candidate);

/// Sec. IV-C, last paragraph: gives the leftovers from the `first` on to planes.
void assign_leftovers(SegmentState& state, std::size_t first = 0);

}  // namespace planescope::planes
