#pragma once

// Random access to a trace: the state of any node, point or plane after any number of events. Step
// k, 0 <= k <= steps(), is the state after the first k events and all of their effects; it does not
// depend on later events.

#include <cstdint>
#include <span>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::debug {

enum class NodeState : std::uint8_t {
  unborn,   // its parent is not divided yet
  queued,   // waiting in Q_N
  visited,  // dequeued, not settled yet
  settled,  // case known
};

class Timeline {
 public:
  Timeline() = default;
  /// From a segmentation with a trace.
  Timeline(const planes::Trace& trace, const planes::Segmentation& segmentation);

  /// From a result without a trace: planes exist from step 0 on, and there are no further steps.
  Timeline(const planes::Segmentation& segmentation, std::span<const Vec3f> points);

  std::int32_t steps() const { return steps_; }

  // Nodes. The step from which on each is queued, dequeued, settled; kNever if never.
  std::span<const std::int32_t> queued_at() const { return queued_at_; }
  std::span<const std::int32_t> visited_at() const { return visited_at_; }
  std::span<const std::int32_t> decided_at() const { return decided_at_; }
  NodeState node_state(std::int32_t node, std::int32_t step) const;

  // Points, by index in segment()'s input. A point follows its plane when that joins another plane;
  // each join is a change.
  std::vector<planes::PointChange> changes_of_point(std::int32_t point) const;  // by step
  planes::PointChange point_at(std::int32_t point, std::int32_t step) const;
  /// The deepest node that contains the point and exists at `step`; -1 without an octree.
  std::int32_t node_of_point(std::int32_t point, std::int32_t step) const;
  /// All nodes that ever contain the point, from the root on.
  std::vector<std::int32_t> path_of_point(std::int32_t point) const;

  // Planes of the trace, in order of creation.
  std::int32_t plane_count() const { return static_cast<std::int32_t>(planes_first_.size()) - 1; }
  std::span<const planes::PlaneChange> changes_of_plane(std::int32_t plane) const;  // by step
  /// Null before it is created.
  const planes::PlaneChange* plane_at(std::int32_t plane, std::int32_t step) const;
  Label label_of_plane(std::int32_t plane) const { return changes_of_plane(plane).front().label; }
  /// The plane it has become part of by a step, following joins; or itself.
  std::int32_t joined_plane(std::int32_t plane, std::int32_t step) const;
  /// Id in the result (PlaneRegion::id); 0 if not part of it.
  std::int32_t result_of_plane(std::int32_t plane) const { return result_of_plane_[plane]; }
  /// Number of a plane at every step, from 1: its id in the result, as in planes.json. Planes
  /// missing from the result get subsequent numbers, in order of creation.
  std::int32_t number_of_plane(std::int32_t plane) const { return number_of_plane_[plane]; }
  /// -1 if there is none.
  std::int32_t plane_of_number(std::int32_t number) const;
  std::int32_t greatest_number() const;  // 0: there are no planes

 private:
  /// Step at which a plane joins another; kNever if it does not.
  struct Join {
    std::int32_t step = planes::kNever;
    std::int32_t into = -1;
  };

  void number_planes(const planes::Segmentation& segmentation);

  std::int32_t steps_ = 0;
  std::vector<std::int32_t> queued_at_, visited_at_, decided_at_;
  std::vector<std::uint32_t> points_first_, planes_first_{0};
  std::vector<planes::PointChange> point_changes_;
  std::vector<planes::PlaneChange> plane_changes_;
  std::vector<Join> joins_;  // per plane
  std::vector<std::int32_t> result_of_plane_, number_of_plane_, plane_of_number_;
  std::vector<std::int32_t> leaf_of_point_;  // the deepest node that ever contains each point
  std::vector<std::int32_t> parents_;
};

}  // namespace planescope::debug
