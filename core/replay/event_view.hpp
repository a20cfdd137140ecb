#pragma once

// What there is to know of an event, for the filter language. Internal to core/replay.

#include <limits>

#include "core/replay/run.hpp"

namespace planescope {

struct EventView {
  const Run& run;
  std::int32_t step;
  const TraceEvent& event;

  bool is_decide() const { return event.type == EventType::decide; }
  const OctreeNode* node() const {
    return event.node >= 0 ? &run.octree().nodes[event.node] : nullptr;
  }
  /// What the criteria see of the node; null when it is visited: nothing has been computed yet.
  const NodeFacts* facts() const {
    return event.node >= 0 && event.type != EventType::visit ? &run.facts[event.node] : nullptr;
  }
  /// The same where the fit came to be: asked for by Criterion 3, or the candidate's own.
  const NodeFacts* fitted() const;
};

/// The value of a field that the event does not have: NaN.
inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

double result_of(const EventView& e);  // id in the result of what its plane became
double label_of(const EventView& e);
double sigma_ang_deg_of(const EventView& e);
double theta_rms_of(const EventView& e);             // [m]
double tau_of(const EventView& e);                   // [m]
double coordinate_of(const EventView& e, int axis);  // world: of the node's centre or the point [m]
double true_plane_of(const EventView& e);
double true_planes_of(const EventView& e);
double true_purity_of(const EventView& e);
bool is_mixed(const EventView& e);
bool is_wrong(const EventView& e);

}  // namespace planescope
