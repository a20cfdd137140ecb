// History of a point, and the decision that left it unassigned or put it into a wrong plane.

#include "core/debug/explain/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/debug/explain/explain.hpp"
#include "core/debug/explain/score.hpp"
#include "core/planes/pipeline/options_table.hpp"

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
  if (voxels.size_m <= 0) return fmt::format("at {}", place);
  return fmt::format("voxel {}: mean of {} points in a cell of {}, at {}", voxel,
                     voxels.count[voxel], distance_text(voxels.size_m), place);
}

std::string describe_label(const Run& run, std::uint32_t voxel) {
  if (!run.is_ours())
    return fmt::format("no label: method {} labels no points",
                       planes::to_string(run.options.method));
  if (run.is_on_image()) return "no label: planes of a depth image are found without labels";
  if (!run.subject->prepared.gravity.known()) return "no label: gravity is unknown";
  const planes::Classification& labels = run.subject->prepared.classification;
  const VoxelTruth& truth = run.subject->voxel_truth;
  std::string text =
      fmt::format("label {} with margin {:.2f}", labels.labels[voxel] == Label::v ? "v" : "h",
                  labels.margins[voxel]);
  if (!truth.label.empty() && truth.label[voxel] > 0) {
    const bool right = truth.label[voxel] == static_cast<std::uint8_t>(labels.labels[voxel]);
    text += right ? ", correct"
                  : fmt::format(", but ground truth is {}", truth.label[voxel] == 2 ? "v" : "h");
  }
  if (!run.segment_options.use_labels) text += " (labels unused)";
  return text;
}

std::string stage_of(const planes::TraceEvent& event) {
  switch (event.type) {
    case planes::EventType::found:
    case planes::EventType::merge:
      return event.node < 0 ? planes::to_string(event.stage) : "merge";
    case planes::EventType::assign:
    case planes::EventType::drop:
      return "leftover";
    case planes::EventType::refine:
      return planes::to_string(event.stage);
    default:
      return "node";
  }
}

/// Describes the point's role in an event that left it over; otherwise empty.
std::string after(const Run& run, std::int32_t step, std::int32_t voxel) {
  const planes::PointChange now = run.timeline.point_at(voxel, step);
  const planes::TraceEvent& event = *run.event_at(step);
  if (now.step != step || !now.leftover || event.type != planes::EventType::decide) return {};
  const planes::Case decided = run.octree().nodes[event.node].decided;
  if (decided == planes::Case::II || run.octree().nodes[event.node].at_max_depth)
    return "; unassigned";
  return "; an outlier: unassigned";
}

std::string describe_result(const Run& run, std::int32_t voxel) {
  const std::int32_t id = run.segmentation.plane_of[voxel];
  const VoxelTruth& truth = run.subject->voxel_truth;
  std::string text = "unassigned";
  if (id > 0) {
    const Vec3d p = run.subject->prepared.voxels.points[voxel].cast<double>();
    const double distance = run.segmentation.planes[id - 1].fit.distance_m(p);
    text =
        fmt::format("in {}, {} away", describe_plane(run, id), distance_text(std::abs(distance)));
  }
  if (!truth.known() || truth.plane[voxel] < 0) return text;
  const std::int32_t own = truth.plane[voxel];
  if (own == (id > 0 ? truth_of_plane(run, id) : 0)) return text + ", correctly";
  return text + (own > 0 ? fmt::format(", but it belongs to true plane {}", own)
                         : std::string(", but it belongs to no true plane"));
}

/// Why a point was left over, and a change that would prevent it.
struct Cause {
  std::string text;
  Remedy remedy = {};
  bool outlier = false;  // was left over as an outlier and is lost because its later
                         // assignment failed
};

/// Rounded up to three digits.
std::string rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return fmt::format("{:.6g}", std::ceil(value / unit) * unit);
}

/// Rounded down to three digits.
std::string rounded_down(double value) {
  if (!(value > 0)) return "0";
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return fmt::format("{:.6g}", std::floor(value / unit) * unit);
}

Cause too_few(const Run& run, std::int32_t node) {
  const std::uint32_t n_in = run.facts[node].purity.n_in;
  Cause cause{fmt::format("node {} has {} inliers, fewer than {} (case II)", node, n_in,
                          run.segment_options.theta_n_in)};
  if (n_in >= 3)  // smallest value of the option
    cause.remedy = {fmt::format("theta_n_in <= {} would fit a plane in node {}", n_in, node),
                    "theta_n_in", std::to_string(n_in)};
  return cause;
}

Cause at_greatest_depth(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  if (run.octree().nodes[node].decided == planes::Case::I)
    return {fmt::format("node {} is mixed ({} and {} points) at the deepest level (case I)", node,
                        facts.purity.n_in, facts.purity.n_out)};
  constexpr const char* kText =
      "node {} is not planar at the deepest level (case III: {} {:.4g} {} > {:.4g})";
  if (run.segment_options.by_objective())
    return {fmt::format(kText, node, "RMS", facts.e_n, "m", facts.theta_e_n)};
  return {fmt::format(kText, node, "e_n", facts.e_n, "m²", facts.theta_e_n),
          {fmt::format("theta_e_n_m2 >= {:.3g} would make node {} a plane", facts.e_n, node),
           "theta_e_n_m2", rounded_up(facts.e_n)}};
}

Cause outlier(const Run& run, std::int32_t node, std::int32_t voxel) {
  const planes::Purity& purity = run.facts[node].purity;
  const planes::Classification& labels = run.subject->prepared.classification;
  return {fmt::format("label {} (margin {:.2f}) among {} points of {} in node {}",
                      labels.labels[voxel] == Label::v ? "v" : "h", labels.margins[voxel],
                      purity.n_in, purity.inlier == Label::v ? "v" : "h", node),
          {},
          true};
}

/// For a node of an image's octree that was not divided.
Cause left_on_image(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  Cause cause{fmt::format("node {} ({}) creates no region, and no nearby region claimed the point",
                          node, decision_text(run, node))};
  if (run.octree().nodes[node].decided == planes::Case::III) {
    const std::string flat = rounded_up(facts.e_n);
    cause.remedy = {fmt::format("flat >= {} would make node {} a plane", flat, node), "flat", flat};
  } else if (facts.e_n < facts.theta_e_n) {
    const std::string filled = rounded_down(facts.e_n);
    cause.remedy = {fmt::format("filled <= {} would fit a plane in node {}", filled, node),
                    "filled", filled};
  }
  return cause;
}

Cause dropped(const Run& run, const planes::TraceEvent& event) {
  const std::string why = filled_in(planes::info_of(event.stage)->why_dropped, run, event);
  Cause cause{fmt::format("{} was dropped ({}){}{}", plane_name(run, event.plane),
                          planes::to_string(event.stage), why.empty() ? "" : ": ", why)};
  if (event.stage == planes::Stage::grow) cause.text += ", and no nearby region claimed the point";
  if (event.stage == planes::Stage::list) {
    const char* option = run.is_on_image() ? "worth_px" : "plane_cost";
    const std::string worth = rounded_down(event.value);
    const auto points = run.timeline.plane_at(event.plane, run.steps())->moments.count;
    cause.text =
        fmt::format("{} was dropped: its {:.0f} {} are worth {:.0f}, below the minimum of {} ({})",
                    plane_name(run, event.plane), points, run.is_on_image() ? "px" : "points",
                    event.value, planes::find_option(option).get(run.options), option);
    cause.remedy = {fmt::format("{} <= {} would keep it", option, worth), option, worth};
  }
  return cause;
}

Cause cause_of(const Run& run, const planes::TraceEvent& event, std::int32_t voxel) {
  if (event.type == planes::EventType::decide && run.is_on_image())
    return left_on_image(run, event.node);
  if (event.type == planes::EventType::decide) {
    const planes::OctreeNode& node = run.octree().nodes[event.node];
    if (node.decided == planes::Case::II) return too_few(run, event.node);
    if (node.at_max_depth) return at_greatest_depth(run, event.node);
    return outlier(run, event.node, voxel);
  }
  return dropped(run, event);
}

WhyNot lost(const Run& run, std::int32_t voxel) {
  if (!run.is_ours())
    return {fmt::format("Lost: method {} found no plane for it, and records no reasons",
                        planes::to_string(run.options.method))};
  const Loss loss = loss_of(run, voxel);
  if (loss.left == 0) return {"Lost: its plane has no points left"};
  const planes::TraceEvent& left = *run.event_at(loss.left);
  const Cause cause = cause_of(run, left, voxel);
  WhyNot why{fmt::format("Lost at step {}: {}", loss.left, cause.text), loss.left, left.node,
             left.plane, cause.remedy};
  if (loss.dropped == 0) return why;
  const LeftoverReport leftover = explain_leftover(run, loss.dropped);
  if (!cause.outlier) {
    why.answer += fmt::format("; afterwards {} (step {})", leftover.outcome, loss.dropped);
    return why;
  }
  why.step = loss.dropped;
  why.answer = fmt::format("Lost at step {}: {}, {}", loss.dropped, cause.text, leftover.outcome);
  if (leftover.planes.empty()) return why;
  const LeftoverPlane& nearest = leftover.planes.front();
  why.plane = nearest.plane;
  if (run.segment_options.by_objective()) return why;
  why.remedy = {fmt::format("leftover_distance_m >= {:.3g} would assign it to {}",
                            nearest.distance_m, plane_name(run, nearest.plane)),
                "leftover_distance_m", rounded_up(nearest.distance_m)};
  return why;
}

/// The merge that first combined nodes of both true planes in this plane of the result; 0 if there
/// is none.
std::int32_t step_of_fusion(const Run& run, std::int32_t id, std::int32_t own, std::int32_t most) {
  const auto ends_in = [&](std::int32_t plane) {
    for (std::int32_t into = plane; into >= 0;
         into = run.timeline.plane_at(plane, run.steps())->into)
      plane = into;
    return run.timeline.result_of_plane(plane);
  };
  bool has_own = false, has_most = false;
  std::int32_t fused = 0;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.type == planes::EventType::found && event.node < 0 && ends_in(event.other) == id)
      has_own = has_most = false, fused = 0;  // split since
    const bool joins =
        event.type == planes::EventType::found || event.type == planes::EventType::merge;
    if (!joins || event.node < 0 || ends_in(event.plane) != id) continue;
    const std::int32_t truth = run.facts[static_cast<std::size_t>(event.node)].truth_plane;
    if (truth != own && truth != most) continue;
    const bool had_both = has_own && has_most;
    (truth == own ? has_own : has_most) = true;
    if (has_own && has_most && !had_both && event.type == planes::EventType::merge) fused = step;
  }
  return fused;
}

/// With the objective: the join of regions of the two true planes that put the voxel into the same
/// plane as both; 0 if there is none.
std::int32_t step_of_join(const Run& run, std::int32_t voxel, std::int32_t own, std::int32_t most) {
  // Per plane, points of `own` minus points of `most`, from the nodes that created it.
  std::vector<double> surplus(static_cast<std::size_t>(run.timeline.plane_count()));
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.type == planes::EventType::found && event.node >= 0) {
      const NodeFacts& facts = run.facts[event.node];
      if (facts.truth_plane == own) surplus[event.plane] = facts.truth_points;
      if (facts.truth_plane == most) surplus[event.plane] = -1.0 * facts.truth_points;
    }
    if (!is_join(event)) continue;
    if (surplus[event.plane] * surplus[event.other] < 0 &&
        run.timeline.point_at(voxel, step).plane == event.other)
      return step;
    surplus[event.other] += surplus[event.plane];
  }
  return 0;
}

/// The option value at which a join would not have happened.
Remedy kept_apart(const Run& run, const planes::TraceEvent& event) {
  const bool hidden = event.stage == planes::Stage::hidden;
  const double scale = hidden ? run.segment_options.objective.merge_cost : 1;
  const std::string limit = rounded_down(event.value / scale);
  const char* option = hidden ? "hidden_share" : "merge_cost";
  return {fmt::format("{} <= {} would have kept them apart", option, limit), option, limit};
}

WhyNot in_a_plane(const Run& run, std::int32_t voxel) {
  const std::int32_t id = run.segmentation.plane_of[voxel];
  WhyNot why;
  why.step = step_of_plane(run, voxel);
  why.plane = run.segmentation.planes[id - 1].founded;
  if (const planes::TraceEvent* event = run.event_at(why.step)) why.node = event->node;
  why.answer = "In " + describe_plane(run, id);
  if (run.is_ours()) why.answer += fmt::format(" since step {}", why.step);

  const VoxelTruth& truth = run.subject->voxel_truth;
  if (!truth.known() || truth.plane[voxel] < 0) return why;
  const std::int32_t own = truth.plane[voxel], most = truth_of_plane(run, id);
  if (own == most) {
    why.answer += fmt::format(", correctly: true plane {}", own);
    return why;
  }
  why.answer += own > 0 ? fmt::format(", but it belongs to true plane {}", own)
                        : std::string(", but it belongs to no plane");
  why.answer += fmt::format("; most of that plane belongs to {}", most);
  const bool by_objective = run.segment_options.by_objective();
  const std::int32_t merge =
      by_objective ? step_of_join(run, voxel, own, most) : step_of_fusion(run, id, own, most);
  if (merge == 0) return why;
  why.step = merge;
  why.node = run.event_at(merge)->node;
  why.answer += fmt::format("; they were merged at step {}: {}", merge, describe_event(run, merge));
  if (by_objective)
    why.remedy = kept_apart(run, *run.event_at(merge));
  else
    why.remedy = {fmt::format("merge_offset_m < {:.3g} would have kept node {} apart",
                              run.event_at(merge)->value, why.node),
                  "merge_offset_m", fmt::format("{:.2g}", 0.95 * run.event_at(merge)->value)};
  return why;
}

}  // namespace

std::vector<HistoryEvent> history_of(const Run& run, std::size_t source) {
  std::vector<HistoryEvent> history;
  if (source < run.subject->point_of_source.size())
    history.push_back({"pixel", describe_source(run.subject->frame, source)});
  if (const std::optional<Absence> absence = absence_of(run, source)) {
    history.push_back({"result", absence->text, -1, -1, -1, true});
    return history;
  }
  const std::uint32_t voxel = run.subject->voxel_of_source(source);
  const auto point = static_cast<std::int32_t>(voxel);
  history.push_back({"voxel", describe_voxel(*run.subject, voxel)});
  history.push_back({"label", describe_label(run, voxel)});
  const std::int32_t decisive = why_not(run, source).step;
  std::set<std::int32_t> steps = steps_of_point(run, point);
  if (decisive > 0) steps.insert(decisive);  // include the merge of another node
  for (const std::int32_t step : steps) {
    const planes::TraceEvent& event = *run.event_at(step);
    history.push_back({stage_of(event), describe_event(run, step) + after(run, step, point), step,
                       event.node, event.plane, step == decisive});
  }
  const std::int32_t id = run.segmentation.plane_of[voxel];
  history.push_back({"result", describe_result(run, point), -1, -1,
                     id > 0 ? run.segmentation.planes[id - 1].founded : -1});
  return history;
}

std::string point_name(const Run& run, std::int32_t voxel) {
  const planes::PreparedFrame& prepared = run.subject->prepared;
  if (prepared.voxels.size_m > 0) return fmt::format("voxel {}", voxel);
  const std::size_t source = source_of_voxel(*run.subject, static_cast<std::uint32_t>(voxel));
  if (!prepared.of_pixels) return fmt::format("point {}", source);
  const auto width = static_cast<std::size_t>(run.subject->frame.depth.width);
  return fmt::format("pixel {},{}", source % width, source / width);
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
    if (voxels.count[voxel] == 1) break;
  }
  return best;
}

std::string describe_plane(const Run& run, std::int32_t id) {
  const planes::PlaneRegion& plane = run.segmentation.planes[id - 1];
  const char* label = plane.label == Label::v ? " (v)" : plane.label == Label::h ? " (h)" : "";
  return fmt::format("P{}{}", id, label);
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
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (run.event_at(step)->point == voxel) steps.insert(step);
  steps.erase(0);
  steps.erase(planes::kNever);
  return steps;
}

std::int32_t step_of_plane(const Run& run, std::int32_t voxel) {
  const planes::PointChange last = run.timeline.point_at(voxel, run.steps());
  return last.plane >= 0 ? last.step : 0;
}

std::int32_t step_of_meeting(const Run& run, std::int32_t a, std::int32_t b) {
  std::set<std::int32_t> steps;
  for (const std::int32_t voxel : {a, b})
    for (const planes::PointChange& change : run.timeline.changes_of_point(voxel))
      steps.insert(change.step);
  std::int32_t met = 0;
  for (const std::int32_t step : steps) {
    const std::int32_t plane = run.timeline.point_at(a, step).plane;
    const bool together = plane >= 0 && plane == run.timeline.point_at(b, step).plane;
    met = !together ? 0 : met > 0 ? met : step;
  }
  return met;
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

std::optional<Absence> absence_of(const Run& run, std::size_t source) {
  const Subject& subject = *run.subject;
  if (source >= subject.point_of_source.size()) return Absence{"no such point"};
  if (subject.point_of_source[source] == planes::kNoVoxel) return Absence{"no measurement here"};
  if (subject.voxel_of_source(source) != planes::kNoVoxel) return {};
  const planes::CloudOptions& options = run.options.cloud;
  const Frame& frame = subject.frame;
  const double range = frame.is_cloud() ? frame.cloud->points[source].cast<double>().norm()
                                        : frame.depth.data[source] * frame.depth_unit_m;
  if (range > options.max_range_m && (!frame.is_cloud() || options.range_for_clouds))
    return Absence{fmt::format("cropped: {} {:.3f} m > {:g} m (max_range_m)",
                               frame.is_cloud() ? "range" : "depth", range, options.max_range_m),
                   {fmt::format("max_range_m >= {:.3f} would keep it", range), "max_range_m",
                    fmt::format("{:.2f}", std::ceil(range * 20) / 20)}};
  const double edge_m = subject.prepared.cloud.cube.edge_m;
  return Absence{fmt::format("cropped: outside the octree's cube of {:g} m", edge_m),
                 {fmt::format("cube_edge_m > {:g} may contain it", options.cube_edge_m),
                  "cube_edge_m", fmt::format("{:g}", 2 * edge_m)}};
}

WhyNot why_not(const Run& run, std::size_t source) {
  if (const std::optional<Absence> absence = absence_of(run, source))
    return {"Not segmented: " + absence->text, -1, -1, -1, absence->remedy};
  const auto voxel = static_cast<std::int32_t>(run.subject->voxel_of_source(source));
  return run.segmentation.plane_of[voxel] > 0 ? in_a_plane(run, voxel) : lost(run, voxel);
}

}  // namespace planescope::debug
