// What the segmentation of a depth image writes into its trace.

#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

void write_plane(DepthTrace& traced, std::int32_t region) {
  traced.trace->planes.push_back({region, {traced.planes[region], traced.trace->steps()}});
}

void refit(GrowingPlane& plane) {
  if (plane.moments.count >= 3) plane.fit = fit_plane(plane.moments);
}

}  // namespace

void log_founded(DepthSegmentation& s,
                 const Octree& octree,
                 std::int32_t region,
                 std::int32_t node) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  GrowingPlane plane;
  for (std::uint32_t i = octree.nodes[node].begin; i < octree.nodes[node].end; ++i) {
    const Vec3d at = octree.points[i].cast<double>();
    plane.moments.add(at);
  }
  refit(plane);
  plane.label = traced.label_of(plane.fit);
  traced.trace->events.push_back(
      {.type = EventType::found, .label = plane.label, .node = node, .plane = region});
  traced.planes.push_back(plane);
  write_plane(traced, region);
  for (std::uint32_t i = octree.nodes[node].begin; i < octree.nodes[node].end; ++i)
    traced.trace->points.push_back({i, {traced.trace->steps(), region, false}});
}

void log_join(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  traced.trace->events.push_back({.type = EventType::refine,
                                  .stage = stage,
                                  .plane = from,
                                  .other = into,
                                  .value = static_cast<float>(cost)});
  GrowingPlane &gone = traced.planes[from], &grown = traced.planes[into];
  grown.moments += gone.moments;
  refit(grown);
  gone.alive = false;
  gone.into = into;  // its points follow: Timeline looks there
  write_plane(traced, from);
  write_plane(traced, into);
}

void log_growth(DepthSegmentation& s, const std::vector<std::int32_t>& before) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  // An event for each region that takes pixels or loses some, in order.
  std::vector<std::vector<std::uint32_t>> taken(s.regions.size()), freed(s.regions.size());
  std::vector<std::uint32_t> lost(s.regions.size(), 0);
  std::vector<Moments> moments(s.regions.size());
  for (const std::uint32_t pixel : s.cells.pixels) {
    const std::int32_t was = before[pixel], is = s.region_of[pixel];
    if (is >= 0) {
      const Vec3d at = traced.points[traced.position[pixel]].cast<double>();
      moments[is].add(at);
    }
    if (was == is) continue;
    if (was >= 0) ++lost[was];
    if (is >= 0)
      taken[is].push_back(traced.position[pixel]);
    else
      freed[was].push_back(traced.position[pixel]);
  }
  for (std::int32_t region = 0; region < static_cast<std::int32_t>(taken.size()); ++region) {
    GrowingPlane& plane = traced.planes[region];
    if (!plane.alive || (taken[region].empty() && lost[region] == 0)) continue;
    const bool ends = !s.regions[region].alive;
    traced.trace->events.push_back({.type = EventType::refine,
                                    .stage = Stage::grow,
                                    .plane = region,
                                    .value = ends ? static_cast<float>(s.regions[region].moments.n)
                                                  : static_cast<float>(taken[region].size()) -
                                                        static_cast<float>(lost[region])});
    plane.moments = moments[region];
    refit(plane);
    plane.alive = !ends;
    write_plane(traced, region);
    for (const std::uint32_t i : taken[region])
      traced.trace->points.push_back({i, {traced.trace->steps(), region, false}});
    for (const std::uint32_t i : freed[region])
      traced.trace->points.push_back({i, {traced.trace->steps(), kNoRegion, true}});
  }
}

void log_drop(DepthSegmentation& s, Stage stage, std::int32_t region, double value) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  traced.trace->events.push_back({.type = EventType::refine,
                                  .stage = stage,
                                  .plane = region,
                                  .value = static_cast<float>(value)});
  traced.planes[region].alive = false;
  write_plane(traced, region);
  for (const std::uint32_t pixel : s.cells.pixels)
    if (s.region_of[pixel] == region)
      traced.trace->points.push_back(
          {traced.position[pixel], {traced.trace->steps(), kNoRegion, true}});
}

}  // namespace planescope::planes
