#include "core/explain/point_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planescope {
namespace {

struct Pixel {
  int u = 0, v = 0;
};

Pixel pixel_of(const Frame& frame, std::size_t source) {
  const auto width = static_cast<std::size_t>(frame.depth.width);
  return {static_cast<int>(source % width), static_cast<int>(source / width)};
}

double depth_m(const Frame& frame, std::size_t source) {
  const Pixel p = pixel_of(frame, source);
  return frame.depth.at(p.u, p.v) * frame.depth_unit_m;
}

}  // namespace

std::string describe_source(const Subject& subject, std::size_t source) {
  const Frame& frame = subject.frame;
  if (!frame.is_cloud()) {
    const Pixel p = pixel_of(frame, source);
    const double depth = depth_m(frame, source);
    if (depth <= 0) return fmt::format("pixel ({}, {}): no depth", p.u, p.v);
    return fmt::format("pixel ({}, {}): depth {:.3f} m", p.u, p.v, depth);
  }
  const Vec3f& p = frame.cloud->points[source];
  return fmt::format("point {} of the file: ({:.3f}, {:.3f}, {:.3f}) m", source, p.x(), p.y(),
                     p.z());
}

std::optional<Absence> absence_of(const Run& run, std::size_t source) {
  const Subject& subject = *run.subject;
  if (source >= subject.point_of_source.size()) return Absence{"no such point", {}};
  const std::uint32_t point = subject.point_of_source[source];
  if (point == kNoVoxel) return Absence{"nothing was measured here", {}};
  if (subject.prepared.voxels.voxel_of[point] != kNoVoxel) return {};
  const CloudOptions& options = run.options.cloud;
  const Frame& frame = subject.frame;
  const double range =
      frame.is_cloud() ? frame.cloud->points[source].cast<double>().norm() : depth_m(frame, source);
  if (range > options.max_range_m && (!frame.is_cloud() || options.range_for_clouds))
    return Absence{fmt::format("cropped: {} {:.3f} m > {:g} m (max_range_m)",
                               frame.is_cloud() ? "range" : "depth", range, options.max_range_m),
                   {fmt::format("max_range_m >= {:.3f} would keep it", range), "max_range_m",
                    fmt::format("{:.2f}", std::ceil(range * 20) / 20)}};
  return Absence{fmt::format("cropped: outside the octree's cube of {:g} m",
                             subject.prepared.cloud.cube.edge_m),
                 {fmt::format("cube_edge_m > {:g} may hold it", options.cube_edge_m), "cube_edge_m",
                  fmt::format("{:g}", 2 * subject.prepared.cloud.cube.edge_m)}};
}

std::string describe_plane(const Run& run, std::int32_t id) {
  const PlaneRegion& plane = run.segmentation.planes[id - 1];
  return fmt::format("plane {} ({}, {})", id, plane_name(plane.founded),
                     plane.label == Label::v ? "v" : "h");
}

std::int32_t truth_of_plane(const Run& run, std::int32_t id) {
  const VoxelTruth& truth = run.subject->voxel_truth;
  if (!truth.known()) return 0;
  std::vector<std::uint32_t> counts(truth.plane_count + 1, 0);
  for (std::size_t i = 0; i < truth.plane.size(); ++i)
    if (run.segmentation.plane_of[i] == id && truth.plane[i] > 0) ++counts[truth.plane[i]];
  const auto most = std::max_element(counts.begin(), counts.end());
  return *most > 0 ? static_cast<std::int32_t>(most - counts.begin()) : 0;
}

std::set<std::int32_t> steps_of_point(const Run& run, std::int32_t voxel) {
  std::set<std::int32_t> steps;
  for (const std::int32_t node : run.timeline.path_of_point(voxel))
    steps.insert(run.timeline.decided_at()[node]);
  for (const PointChange& change : run.timeline.changes_of_point(voxel)) steps.insert(change.step);
  const std::int32_t leaf = run.timeline.node_of_point(voxel, run.steps());
  const Label label = run.subject->prepared.classification.labels[voxel];
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const TraceEvent& event = *run.event_at(step);
    const bool of_candidate = event.type == EventType::wait && event.node == leaf &&
                              (!run.segment_options.use_labels || event.label == label);
    if (of_candidate || event.point == voxel) steps.insert(step);
  }
  steps.erase(0);
  steps.erase(kNever);
  return steps;
}

std::int32_t step_of_plane(const Run& run, std::int32_t voxel) {
  std::int32_t step = 0;
  for (const PointChange& change : run.timeline.changes_of_point(voxel))
    step = change.plane >= 0 ? change.step : 0;
  return step;
}

Loss loss_of(const Run& run, std::int32_t voxel) {
  Loss loss;
  for (const PointChange& change : run.timeline.changes_of_point(voxel))
    if (change.plane < 0) loss.left = change.step;
  for (std::int32_t step = loss.left + 1; step <= run.steps() && loss.dropped == 0; ++step) {
    const TraceEvent& event = *run.event_at(step);
    if (event.type == EventType::drop && event.point == voxel) loss.dropped = step;
  }
  return loss;
}

}  // namespace planescope
