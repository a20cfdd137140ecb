#include "core/replay/event_view.hpp"

#include <optional>

#include "core/replay/truth_check.hpp"

namespace planescope {
namespace {

constexpr double kDegrees = 57.29577951308232;  // per radian

Vec3d position_of(const EventView& e) {
  return e.run.subject->prepared.voxels.points[e.event.point].cast<double>();
}

/// Where it happens, about the cloud's origin: the node's fit, or the point.
std::optional<Vec3d> place_of(const EventView& e) {
  if (const NodeFacts* facts = e.facts()) return facts->fit.centroid;
  if (e.event.point >= 0) return position_of(e);
  return std::nullopt;
}

bool truth_known(const EventView& e) { return e.run.subject->voxel_truth.known(); }

}  // namespace

const NodeFacts* EventView::fitted() const {
  const NodeFacts* known = facts();
  if (!known) return nullptr;
  if (is_decide()) return event.node_case >= static_cast<int>(Case::III) ? known : nullptr;
  return event.label == known->purity.inlier ? known : nullptr;
}

double result_of(const EventView& e) {
  if (e.event.plane < 0) return kAbsent;
  const Timeline& timeline = e.run.timeline;
  std::int32_t plane = e.event.plane;
  for (const PlaneChange* last = timeline.plane_at(plane, timeline.steps()); last->into >= 0;
       last = timeline.plane_at(plane, timeline.steps()))
    plane = last->into;
  return timeline.result_of_plane(plane);
}

double label_of(const EventView& e) {
  if (e.event.label != Label::unknown) return static_cast<double>(e.event.label);
  if (e.event.point >= 0)
    return static_cast<double>(e.run.subject->prepared.classification.labels[e.event.point]);
  if (const NodeFacts* facts = e.facts()) return static_cast<double>(facts->purity.inlier);
  if (e.event.plane >= 0) return static_cast<double>(e.run.timeline.label_of_plane(e.event.plane));
  return kAbsent;
}

double sigma_ang_deg_of(const EventView& e) {
  const bool stated = e.event.type == EventType::wait || e.event.type == EventType::leave;
  if (stated && e.event.node >= 0) return e.event.value * kDegrees;
  const NodeFacts* facts = e.fitted();
  return facts ? facts->sigma_ang * kDegrees : kAbsent;
}

double theta_rms_of(const EventView& e) {
  const auto place = place_of(e);
  return place ? e.run.theta_rms(*place) : kAbsent;
}

double tau_of(const EventView& e) {
  const auto place = place_of(e);
  return place ? e.run.tau(*place) : kAbsent;
}

double coordinate_of(const EventView& e, int axis) {
  const double origin = e.run.subject->prepared.cloud.origin[axis];
  if (const OctreeNode* node = e.node()) {
    const Octree& octree = e.run.octree();
    return origin + octree.node_min(*node)[axis] + octree.node_edge_m(*node) / 2;
  }
  return e.event.point >= 0 ? origin + position_of(e)[axis] : kAbsent;
}

double true_plane_of(const EventView& e) {
  if (!truth_known(e)) return kAbsent;
  if (e.event.point >= 0) return e.run.subject->voxel_truth.plane[e.event.point];
  const NodeFacts* facts = e.facts();
  return facts ? facts->truth_plane : kAbsent;
}

double true_planes_of(const EventView& e) {
  const NodeFacts* facts = e.facts();
  return facts && truth_known(e) ? facts->truth_planes : kAbsent;
}

double true_purity_of(const EventView& e) {
  const NodeFacts* facts = e.facts();
  return facts && truth_known(e) ? static_cast<double>(facts->truth_points) / e.node()->size()
                                 : kAbsent;
}

bool is_mixed(const EventView& e) {
  const NodeFacts* facts = e.facts();
  return facts && truth_known(e) && is_mixed_in_truth(*facts, e.run.segment_options);
}

bool is_wrong(const EventView& e) {
  return !e.run.wrong.empty() && e.run.wrong[static_cast<std::size_t>(e.step - 1)] != 0;
}

}  // namespace planescope
