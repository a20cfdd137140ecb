// What of one run is what of another: nodes by their cells, voxels by their pixels.

#include "core/debug/explain/compare.hpp"

namespace planescope::debug {
namespace {

std::vector<std::int32_t> voxels_by_source(const Subject& from, const Subject& to) {
  std::vector<std::int32_t> voxels(from.voxel_count(), -1);
  const std::vector<std::uint32_t>& voxel_of = from.prepared.voxels.voxel_of;
  for (std::size_t i = voxel_of.size(); i-- > 0;) {  // the first one stays
    if (voxel_of[i] == planes::kNoVoxel) continue;
    const std::uint32_t other = to.voxel_of_source(from.prepared.cloud.source[i]);
    if (other != planes::kNoVoxel) voxels[voxel_of[i]] = static_cast<std::int32_t>(other);
  }
  return voxels;
}

/// The step of the last event of `to` that answers to `event`, 0 where there is none.
std::int32_t step_of(const Correspondence& same, const planes::TraceEvent& event, const Run& to) {
  for (std::int32_t step = to.steps(); step > 0; --step)
    if (same.same_event(event, *to.event_at(step))) return step;
  return 0;
}

/// When the other run settled the node or, where it has none, the nearest above it.
std::int32_t step_of_node(const Correspondence& same,
                          std::int32_t node,
                          const Run& from,
                          const Run& to) {
  for (; node >= 0; node = from.octree().nodes[node].parent)
    if (const std::int32_t found = same.node(node); found >= 0)
      if (const std::int32_t step = to.timeline.decided_at()[found]; step != planes::kNever)
        return step;
  return 0;
}

}  // namespace

Correspondence::Correspondence(const Run& from, const Run& to) : from_(from), to_(to) {
  same_voxels_ = from.subject == to.subject ||
                 (from.subject->prepared.voxels.points == to.subject->prepared.voxels.points &&
                  from.subject->prepared.cloud.source == to.subject->prepared.cloud.source);
  if (!same_voxels_) voxels_ = voxels_by_source(*from.subject, *to.subject);
}

std::int32_t Correspondence::node(std::int32_t node) const {
  const planes::Octree& octree = to_.octree();
  const planes::Cube &here = from_.octree().cube, &there = octree.cube;
  if (octree.nodes.empty() || here.min_corner != there.min_corner || here.edge_m != there.edge_m)
    return -1;
  const planes::OctreeNode& wanted = from_.octree().nodes[node];
  std::int32_t at = 0;
  while (octree.nodes[at].depth < wanted.depth) {
    const planes::OctreeNode& above = octree.nodes[at];
    const std::uint64_t code = wanted.code >> (3 * (wanted.depth - above.depth - 1));
    at = -1;
    for (std::int32_t c = above.first_child; c >= 0 && c < above.first_child + above.child_count;
         ++c)
      if (octree.nodes[c].code == code) at = c;
    if (at < 0) return -1;
  }
  return at;
}

bool Correspondence::same_event(const planes::TraceEvent& from,
                                const planes::TraceEvent& to) const {
  if (from.type != to.type || from.node_case != to.node_case || from.label != to.label ||
      from.stage != to.stage || (from.node < 0) != (to.node < 0) ||
      (from.point < 0) != (to.point < 0))
    return false;
  if (from.node >= 0) return node(from.node) == to.node;
  if (from.point >= 0) return voxel(from.point) == to.point;
  return from.plane == to.plane && from.other == to.other;
}

std::int32_t same_node(const Run& run, std::int32_t node, const Run& other) {
  return Correspondence(run, other).node(node);
}

std::int32_t same_step(const Run& run, std::int32_t step, const Run& other) {
  if (step <= 0) return 0;
  if (step >= run.steps()) return other.steps();
  const Correspondence same(run, other);
  const planes::TraceEvent& event = *run.event_at(step);
  if (const std::int32_t found = step_of(same, event, other)) return found;
  if (event.node >= 0)
    if (const std::int32_t found = step_of_node(same, event.node, run, other)) return found;
  if (const std::int32_t point = event.point >= 0 ? same.voxel(event.point) : -1; point >= 0)
    if (const std::int32_t found = other.timeline.point_at(point, other.steps()).step) return found;
  return static_cast<std::int32_t>(static_cast<std::int64_t>(step) * other.steps() / run.steps());
}

}  // namespace planescope::debug
