// A point's life, station by station.

#include "core/explain/provenance.hpp"

#include <fmt/format.h>

#include <set>

#include "core/explain/check.hpp"
#include "core/explain/point_facts.hpp"

namespace planescope {
namespace {

LifeEvent station(std::string stage, std::string text) {
  LifeEvent event;
  event.stage = std::move(stage);
  event.text = std::move(text);
  return event;
}

std::string describe_voxel(const Subject& subject, std::uint32_t voxel) {
  const VoxelCloud& voxels = subject.prepared.voxels;
  const Vec3d p = voxels.points[voxel].cast<double>() + subject.prepared.cloud.origin;
  const std::string place = fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x(), p.y(), p.z());
  if (voxels.size_m <= 0) return fmt::format("voxel {}: the point itself, at {}", voxel, place);
  return fmt::format("voxel {}: mean of {} points in a cell of {}, at {}", voxel,
                     voxels.count[voxel], distance_text(voxels.size_m), place);
}

std::string describe_label(const Run& run, std::uint32_t voxel) {
  if (!run.is_ours())
    return fmt::format("not labelled: method {} labels no points", to_string(run.options.method));
  const Classification& labels = run.subject->prepared.classification;
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

std::string stage_of(const TraceEvent& event) {
  switch (event.type) {
    case EventType::visit:
    case EventType::decide:
      return "node";
    case EventType::found:
    case EventType::merge:
    case EventType::wait:
      return event.stage == Stage::split_disconnected ? "refinement" : "merge";
    case EventType::assign:
    case EventType::drop:
    case EventType::leave:
      return "leftover";
    case EventType::refine:
      return "refinement";
  }
  return "node";
}

/// Where an event left the point over, what it was there.
std::string after(const Run& run, std::int32_t step, std::int32_t voxel) {
  const PointChange now = run.timeline.point_at(voxel, step);
  const TraceEvent& event = *run.event_at(step);
  if (now.step != step || !now.leftover || event.type != EventType::decide) return {};
  const Case decided = run.octree().nodes[event.node].decided;
  if (decided == Case::II || run.octree().nodes[event.node].at_max_depth) return "; left over";
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
  const std::optional<Absence> absence = absence_of(run, source);
  std::vector<LifeEvent> life;
  if (source < run.subject->point_of_source.size())
    life.push_back(station("pixel", describe_source(*run.subject, source)));
  if (absence) {
    life.push_back(station("result", absence->text));
    life.back().decisive = true;
    return life;
  }
  const std::uint32_t voxel = run.subject->voxel_of_source(source);
  const auto point = static_cast<std::int32_t>(voxel);
  life.push_back(station("voxel", describe_voxel(*run.subject, voxel)));
  life.push_back(station("label", describe_label(run, voxel)));
  const std::int32_t decisive = why_not(run, source).step;
  std::set<std::int32_t> steps = steps_of_point(run, point);
  if (decisive > 0) steps.insert(decisive);  // also where it was another node's merge
  for (const std::int32_t step : steps) {
    const TraceEvent& event = *run.event_at(step);
    LifeEvent entry = station(stage_of(event), describe_event(run, step) + after(run, step, point));
    entry.step = step;
    entry.node = event.node;
    entry.plane = event.plane;
    entry.decisive = step == decisive;
    life.push_back(std::move(entry));
  }
  life.push_back(station("result", describe_result(run, point)));
  const std::int32_t id = run.segmentation.plane_of[voxel];
  if (id > 0) life.back().plane = run.segmentation.planes[id - 1].founded;
  return life;
}

std::size_t source_of_voxel(const Subject& subject, std::uint32_t voxel) {
  const Cloud& cloud = subject.prepared.cloud;
  const VoxelCloud& voxels = subject.prepared.voxels;
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

}  // namespace planescope
