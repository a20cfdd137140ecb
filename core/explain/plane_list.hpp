#pragma once

// The list of planes as a candidate met it. Internal to core/explain.

#include <vector>

#include "core/replay/run.hpp"
#include "core/segment/criteria.hpp"

namespace planescope {

/// Walks forward through the trace. Fits and moments are the timeline's; the boxes of the planes'
/// points, which only R1 asks for, are gathered on the way. Good until the end of the merging.
class PlaneList {
 public:
  explicit PlaneList(const Run& run) : run_(run) {}
  /// To the state at `step`, not before where it is.
  void advance_to(std::int32_t step);

  std::int32_t size() const { return static_cast<std::int32_t>(bounds_.size()); }
  bool alive(std::int32_t plane) const { return at(plane).alive; }
  Label label(std::int32_t plane) const { return run_.timeline.label_of_plane(plane); }
  const PlaneFit& fit(std::int32_t plane) const { return at(plane).fit; }
  MeasuredPlane measured(std::int32_t plane) const;

 private:
  const PlaneChange& at(std::int32_t plane) const { return *run_.timeline.plane_at(plane, step_); }

  const Run& run_;
  std::int32_t step_ = 0;
  std::vector<Bounds> bounds_;  // per plane founded so far
};

/// As R1 takes it; refers to the arguments.
MeasuredPlane measured(const Run& run,
                       const PlaneFit& fit,
                       const Moments& moments,
                       const Bounds& bounds);

/// The trace's plane of each point at a step, -1 none; in Morton order.
std::vector<std::int32_t> planes_of_points(const Run& run, std::int32_t step);

}  // namespace planescope
