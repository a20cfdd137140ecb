// Traces of the public library: events, octree nodes, and the plane of each point at a step.

#include <fmt/format.h>

#include <cstddef>

#include "library/data.hpp"

namespace planescope::v0 {
using detail::Access;
using detail::vec3;

// Core's events have the same layout as the library's.
using CoreEvent = planes::TraceEvent;
static_assert(sizeof(Event) == sizeof(CoreEvent) && sizeof(Event) == 24);
static_assert(offsetof(Event, node_case) == offsetof(CoreEvent, node_case));
static_assert(offsetof(Event, stage) == offsetof(CoreEvent, stage));
static_assert(offsetof(Event, label) == offsetof(CoreEvent, label));
static_assert(offsetof(Event, node) == offsetof(CoreEvent, node));
static_assert(offsetof(Event, plane) == offsetof(CoreEvent, plane));
static_assert(offsetof(Event, other) == offsetof(CoreEvent, other));
static_assert(offsetof(Event, point) == offsetof(CoreEvent, point));
static_assert(offsetof(Event, value) == offsetof(CoreEvent, value));
static_assert(static_cast<int>(EventType::refine) == static_cast<int>(planes::EventType::refine));
static_assert(Node::kNever == planes::kNever);

View<Event> Trace::events() const& {
  const std::vector<CoreEvent>& events = data_->run->trace.events;
  return {reinterpret_cast<const Event*>(events.data()), events.size()};
}

std::vector<std::string> Trace::stages() {
  std::vector<std::string> names;
  for (const planes::Stage stage : planes::stages()) names.emplace_back(planes::to_string(stage));
  return names;
}

std::string Trace::describe(int step) const {
  return detail::guarded([&] {
    if (step < 1 || step > steps())
      throw Error(fmt::format("step {} is out of range; expected 1 to {}", step, steps()));
    return debug::describe_event(*data_->run, step);
  });
}

std::vector<Node> Trace::nodes() const {
  const debug::Run& run = *data_->run;
  const planes::Octree& octree = run.octree();
  std::vector<Node> nodes;
  nodes.reserve(octree.nodes.size());
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    const planes::OctreeNode& from = octree.nodes[i];
    Node node;
    node.parent = from.parent;
    node.depth = from.depth;
    node.node_case = static_cast<std::uint8_t>(from.decided);
    node.voxels = from.size();
    node.voxels_h = from.count_h;
    const auto corners = planes::cell_corners(octree, from);
    for (std::size_t k = 0; k < corners.size(); ++k)
      node.corners[k] = vec3(Vec3d(run.subject->prepared.cloud.origin + corners[k].cast<double>()));
    node.queued = run.timeline.queued_at()[i];
    node.visited = run.timeline.visited_at()[i];
    node.decided = run.timeline.decided_at()[i];
    nodes.push_back(node);
  }
  return nodes;
}

namespace {

std::int32_t plane_at(const debug::Run& run, int step, std::size_t i) {
  const std::uint32_t voxel = run.subject->voxel_of_source(i);
  if (voxel == planes::kNoVoxel) return -1;
  return run.timeline.point_at(static_cast<std::int32_t>(voxel), step).plane;
}

void expect_step(const debug::Run& run, int step) {
  if (step < 0 || step > run.steps())
    throw Error(fmt::format("step {} is out of range; expected 0 to {}", step, run.steps()));
}

}  // namespace

std::vector<std::int32_t> Trace::plane_of(int step) const {
  return detail::guarded([&] {
    expect_step(*data_->run, step);
    std::vector<std::int32_t> plane_of(data_->frame.size());
    for (std::size_t i = 0; i < plane_of.size(); ++i) plane_of[i] = plane_at(*data_->run, step, i);
    return plane_of;
  });
}

std::int32_t Trace::plane_of(int step, std::size_t i) const {
  return detail::guarded([&] {
    expect_step(*data_->run, step);
    if (i >= data_->frame.size())
      throw Error(fmt::format("pixel or point {} is out of range; the frame has {}", i,
                              data_->frame.size()));
    return plane_at(*data_->run, step, i);
  });
}

int Trace::id_of(int plane) const {
  return detail::guarded([&] {
    const debug::Timeline& timeline = data_->run->timeline;
    if (plane < 0 || plane >= timeline.plane_count())
      throw Error(fmt::format("plane {} is out of range; {} were created, numbered from 0", plane,
                              timeline.plane_count()));
    return timeline.result_of_plane(plane);
  });
}

}  // namespace planescope::v0
