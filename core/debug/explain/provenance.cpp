// A point's life, station by station.

#include "core/debug/explain/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/check.hpp"
#include "core/debug/explain/score.hpp"

namespace planescope::debug {
namespace {

/// "pixel (320, 240): depth 0.842 m", "point 17 of the file: (1.20, 0.03, -0.40) m".
std::string describe_source(const Frame& frame, std::size_t source) {
  if (frame.is_cloud()) {
    const Vec3f& p = frame.cloud->points[source];
    return fmt::format("point {} of the file: ({:.3f}, {:.3f}, {:.3f}) m", source, p.x(), p.y(),
                       p.z());
  }
  const auto width = static_cast<std::size_t>(frame.depth.width);
  const double depth_m = frame.depth.data[source] * frame.depth_unit_m;
  return fmt::format("pixel ({}, {}): {}", source % width, source / width,
                     depth_m > 0 ? fmt::format("depth {:.3f} m", depth_m) : "no depth");
}

std::string describe_voxel(const Subject& subject, std::uint32_t voxel) {
  const planes::VoxelCloud& voxels = subject.prepared.voxels;
  const Vec3d p = voxels.points[voxel].cast<double>() + subject.prepared.cloud.origin;
  const std::string place = fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x(), p.y(), p.z());
  if (voxels.size_m <= 0) return fmt::format("voxel {}: the point itself, at {}", voxel, place);
  return fmt::format("voxel {}: mean of {} points in a cell of {}, at {}", voxel,
                     voxels.count[voxel], distance_text(voxels.size_m), place);
}

std::string describe_label(const Run& run, std::uint32_t voxel) {
  if (!run.is_ours())
    return fmt::format("not labelled: method {} labels no points",
                       planes::to_string(run.options.method));
  if (!run.subject->prepared.gravity.known())
    return "not labelled: nobody knows gravity, so nothing is h or v";
  const planes::Classification& labels = run.subject->prepared.classification;
  const VoxelTruth& truth = run.subject->voxel_truth;
  std::string text =
      fmt::format("labelled {} with margin {:.2f}", labels.labels[voxel] == Label::v ? "v" : "h",
                  labels.margins[voxel]);
  if (!truth.label.empty() && truth.label[voxel] > 0) {
    const bool right = truth.label[voxel] == static_cast<std::uint8_t>(labels.labels[voxel]);
    text += right ? ", rightly"
                  : fmt::format(", but truth says {}", truth.label[voxel] == 2 ? "v" : "h");
  }
  if (!run.segment_options.use_labels) text += " (labels are not used)";
  return text;
}

std::string station_of(const planes::TraceEvent& event) {
  switch (event.type) {
    case planes::EventType::found:
    case planes::EventType::merge:
    case planes::EventType::wait:
      return event.node < 0 ? "refinement" : "merge";
    case planes::EventType::assign:
    case planes::EventType::drop:
    case planes::EventType::leave:
      return "leftover";
    case planes::EventType::refine:
      return "refinement";
    default:
      return "node";
  }
}

/// Where an event left the point over, what it was there.
std::string after(const Run& run, std::int32_t step, std::int32_t voxel) {
  const planes::PointChange now = run.timeline.point_at(voxel, step);
  const planes::TraceEvent& event = *run.event_at(step);
  if (now.step != step || !now.leftover || event.type != planes::EventType::decide) return {};
  const planes::Case decided = run.octree().nodes[event.node].decided;
  if (decided == planes::Case::II || run.octree().nodes[event.node].at_max_depth)
    return "; left over";
  return "; an outlier there: left over";
}

std::string describe_result(const Run& run, std::int32_t voxel) {
  const std::int32_t id = run.segmentation.plane_of[voxel];
  const VoxelTruth& truth = run.subject->voxel_truth;
  std::string text = "in no plane";
  if (id > 0) {
    const Vec3d p = run.subject->prepared.voxels.points[voxel].cast<double>();
    const double distance = run.segmentation.planes[id - 1].fit.distance_m(p);
    text =
        fmt::format("in {}, {} off it", describe_plane(run, id), distance_text(std::abs(distance)));
  }
  if (!truth.known() || truth.plane[voxel] < 0) return text;
  const std::int32_t own = truth.plane[voxel];
  if (own == (id > 0 ? truth_of_plane(run, id) : 0)) return text + ", rightly";
  return text + (own > 0 ? fmt::format(", but it belongs to true plane {}", own)
                         : std::string(", but it belongs to none"));
}

}  // namespace

std::vector<LifeEvent> life_of(const Run& run, std::size_t source) {
  std::vector<LifeEvent> life;
  if (source < run.subject->point_of_source.size())
    life.push_back({"pixel", describe_source(run.subject->frame, source)});
  if (const std::optional<Absence> absence = absence_of(run, source)) {
    life.push_back({"result", absence->text, -1, -1, -1, true});
    return life;
  }
  const std::uint32_t voxel = run.subject->voxel_of_source(source);
  const auto point = static_cast<std::int32_t>(voxel);
  life.push_back({"voxel", describe_voxel(*run.subject, voxel)});
  life.push_back({"label", describe_label(run, voxel)});
  const std::int32_t decisive = why_not(run, source).step;
  std::set<std::int32_t> steps = steps_of_point(run, point);
  if (decisive > 0) steps.insert(decisive);  // also where it was another node's merge
  for (const std::int32_t step : steps) {
    const planes::TraceEvent& event = *run.event_at(step);
    life.push_back({station_of(event), describe_event(run, step) + after(run, step, point), step,
                    event.node, event.plane, step == decisive});
  }
  const std::int32_t id = run.segmentation.plane_of[voxel];
  life.push_back({"result", describe_result(run, point), -1, -1,
                  id > 0 ? run.segmentation.planes[id - 1].founded : -1});
  return life;
}

std::size_t source_of_voxel(const Subject& subject, std::uint32_t voxel) {
  const planes::Cloud& cloud = subject.prepared.cloud;
  const planes::VoxelCloud& voxels = subject.prepared.voxels;
  std::size_t best = 0;
  float least = -1;
  for (std::size_t i = 0; i < voxels.voxel_of.size(); ++i) {
    if (voxels.voxel_of[i] != voxel) continue;
    const float distance = (cloud.points[i] - voxels.points[voxel]).squaredNorm();
    if (least >= 0 && distance >= least) continue;
    least = distance;
    best = cloud.source[i];
  }
  return best;
}

std::string describe_plane(const Run& run, std::int32_t id) {
  const planes::PlaneRegion& plane = run.segmentation.planes[id - 1];
  const char* label = plane.label == Label::v ? ", v" : plane.label == Label::h ? ", h" : "";
  return fmt::format("plane {} ({}{})", id, plane_name(plane.founded), label);
}

std::int32_t truth_of_plane(const Run& run, std::int32_t id) {
  const VoxelTruth& truth = run.subject->voxel_truth;
  std::vector<std::int32_t> planes;
  for (std::size_t i = 0; i < truth.plane.size(); ++i)
    if (run.segmentation.plane_of[i] == id) planes.push_back(truth.plane[i]);
  return most_common_plane(planes);
}

std::set<std::int32_t> steps_of_point(const Run& run, std::int32_t voxel) {
  std::set<std::int32_t> steps;
  for (const std::int32_t node : run.timeline.path_of_point(voxel))
    steps.insert(run.timeline.decided_at()[node]);
  for (const planes::PointChange& change : run.timeline.changes_of_point(voxel))
    steps.insert(change.step);
  const std::int32_t leaf = run.timeline.node_of_point(voxel, run.steps());
  const Label label = run.subject->prepared.classification.labels[voxel];
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    const bool of_candidate = event.type == planes::EventType::wait && event.node == leaf &&
                              (!run.segment_options.use_labels || event.label == label);
    if (of_candidate || event.point == voxel) steps.insert(step);
  }
  steps.erase(0);
  steps.erase(planes::kNever);
  return steps;
}

std::int32_t step_of_plane(const Run& run, std::int32_t voxel) {
  const planes::PointChange last = run.timeline.point_at(voxel, run.steps());
  return last.plane >= 0 ? last.step : 0;
}

Loss loss_of(const Run& run, std::int32_t voxel) {
  Loss loss;
  for (const planes::PointChange& change : run.timeline.changes_of_point(voxel))
    if (change.plane < 0) loss.left = change.step;
  for (std::int32_t step = loss.left + 1; step <= run.steps() && loss.dropped == 0; ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.type == planes::EventType::drop && event.point == voxel) loss.dropped = step;
  }
  return loss;
}

}  // namespace planescope::debug
