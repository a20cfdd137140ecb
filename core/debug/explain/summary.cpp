#include "core/debug/explain/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace planescope::debug {
namespace {

/// `points`: that the same step left over.
std::string reason_of(const Run& run,
                      const planes::TraceEvent& left,
                      std::size_t points,
                      bool was_assigned) {
  if (left.type != planes::EventType::decide) {
    if (left.stage == planes::Stage::grow) return "regions of too few points";
    if (left.stage == planes::Stage::list) {
      if (!run.is_on_image()) return "dropped planes: below the minimum worth";
      const double least = run.segment_options.objective.worth_px;
      return static_cast<double>(points) < least
                 ? fmt::format("dropped planes: fewer than {:g} px", least)
                 : fmt::format("dropped planes: uneven, worth less than {:g} px", least);
    }
    return std::string("dropped at ") + planes::to_string(left.stage);
  }
  const planes::OctreeNode& node = run.octree().nodes[left.node];
  if (node.decided == planes::Case::I || node.decided == planes::Case::IV)
    return was_assigned ? "too far from any plane" : "no region within reach";
  return std::string("case ") + planes::to_string(node.decided);
}

/// The steps at which each voxel was left over for the last time, 0: never.
std::vector<std::int32_t> steps_left(const Run& run) {
  std::vector<std::int32_t> steps(run.subject->voxel_count(), 0);
  for (std::size_t voxel = 0; voxel < steps.size(); ++voxel)
    if (run.segmentation.plane_of[voxel] == 0)
      steps[voxel] = run.timeline.point_at(static_cast<std::int32_t>(voxel), run.steps()).step;
  return steps;
}

/// Of the largest group with one step the voxel in its middle.
std::int64_t middle_of(const std::vector<std::uint32_t>& voxels,
                       const std::vector<std::int32_t>& step_of) {
  std::map<std::int32_t, std::vector<std::uint32_t>> by_step;
  for (const std::uint32_t voxel : voxels) by_step[step_of[voxel]].push_back(voxel);
  if (by_step.empty()) return -1;
  const auto& most = std::ranges::max_element(by_step, {}, [](const auto& entry) {
                       return entry.second.size();
                     })->second;
  return most[most.size() / 2];
}

}  // namespace

FrameSummary summary_of(const Run& run) {
  const Subject& subject = *run.subject;
  FrameSummary summary;
  summary.planes = static_cast<int>(run.segmentation.planes.size());
  for (const planes::PlaneRegion& plane : run.segmentation.planes)
    summary.undecided += plane.undecided;
  std::vector<std::uint8_t> was_assigned(subject.voxel_count(), 0);  // to no plane
  for (const planes::TraceEvent& event : run.trace.events)
    if (event.type == planes::EventType::drop && event.point >= 0) was_assigned[event.point] = 1;

  std::map<std::string, Lost> by_reason;
  const std::vector<std::int32_t> left = steps_left(run);
  std::vector<std::size_t> points_left(static_cast<std::size_t>(run.steps()) + 1, 0);
  for (const std::int32_t step : left) ++points_left[static_cast<std::size_t>(step)];
  std::vector<Lost*> lost_by(2 * points_left.size(), nullptr);  // by decision
  for (std::size_t source = 0; source < subject.point_of_source.size(); ++source) {
    if (subject.point_of_source[source] == planes::kNoVoxel) continue;
    ++summary.measured;
    const std::uint32_t voxel = subject.voxel_of_source(source);
    if (voxel == planes::kNoVoxel) {
      ++by_reason["out of range"].sources;
      ++summary.out_of_range;
      if (!subject.frame.is_cloud())
        summary.beyond += subject.frame.depth.data[source] * subject.frame.depth_unit_m >
                          run.options.cloud.max_range_m;
      continue;
    }
    if (const std::int32_t plane = run.segmentation.plane_of[voxel]; plane > 0) {
      ++summary.on_planes;
      summary.on_undecided += run.segmentation.planes[plane - 1].undecided;
      continue;
    }
    // The reason of a decision is told once, not for each of its points.
    Lost*& lost = lost_by[2 * static_cast<std::size_t>(left[voxel]) + was_assigned[voxel]];
    if (!lost)
      lost =
          &by_reason[left[voxel] > 0 ? reason_of(run, *run.event_at(left[voxel]),
                                                 points_left[left[voxel]], was_assigned[voxel] != 0)
                     : run.is_ours() ? "removed from a plane"
                                     : "unassigned"];
    ++lost->sources;
    lost->voxels.push_back(voxel);
  }
  for (auto& [reason, lost] : by_reason) {
    lost.reason = reason;
    std::ranges::sort(lost.voxels);
    const auto [first, last] = std::ranges::unique(lost.voxels);
    lost.voxels.erase(first, last);
    lost.middle = middle_of(lost.voxels, left);
    summary.lost.push_back(std::move(lost));
  }
  std::ranges::stable_sort(summary.lost, std::greater{}, &Lost::sources);
  return summary;
}

}  // namespace planescope::debug
