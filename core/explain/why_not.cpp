// Why a point is in no plane, or in the wrong one: the one decision that made it so.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/explain/check.hpp"
#include "core/explain/explain.hpp"
#include "core/explain/point_facts.hpp"
#include "core/explain/provenance.hpp"
#include "core/replay/truth_check.hpp"

namespace planescope {
namespace {

/// Why a point was left over, and what would have kept it.
struct Cause {
  std::string text;
  Remedy remedy;
  bool outlier = false;  // left over to be assigned later: that this failed is what lost it
};

/// Three digits, not below the value.
std::string rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return fmt::format("{:.6g}", std::ceil(value / unit) * unit);
}

Cause too_few(const Run& run, std::int32_t node) {
  const std::uint32_t n_in = run.facts[node].purity.n_in;
  Cause cause;
  cause.text = fmt::format("node {} has {} inliers, fewer than {} (case II)", node, n_in,
                           run.segment_options.theta_n_in);
  if (n_in >= 3)  // what the option allows
    cause.remedy = {fmt::format("theta_n_in <= {} would ask for a plane in node {}", n_in, node),
                    "theta_n_in", std::to_string(n_in)};
  return cause;
}

Cause at_greatest_depth(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  Cause cause;
  if (run.octree().nodes[node].decided == Case::I) {
    cause.text = fmt::format("node {} is mixed ({} and {} points) at the greatest depth (case I)",
                             node, facts.purity.n_in, facts.purity.n_out);
    return cause;
  }
  const bool rms = run.segment_options.noise.rms_criterion3;
  cause.text = fmt::format("node {} is not planar at the greatest depth (case III: {} {} > {})",
                           node, rms ? "RMS" : "e_n", number(facts.e_n, rms ? "m" : "m²"),
                           number(facts.theta_e_n, ""));
  if (!rms)
    cause.remedy = {
        fmt::format("theta_e_n_m2 >= {:.3g} would take node {} for a plane", facts.e_n, node),
        "theta_e_n_m2", rounded_up(facts.e_n)};
  return cause;
}

Cause outlier(const Run& run, std::int32_t node, std::int32_t voxel) {
  const Purity& purity = run.facts[node].purity;
  const Classification& labels = run.subject->prepared.classification;
  Cause cause;
  cause.outlier = true;
  cause.text = fmt::format("labelled {} (margin {:.2f}) among {} points of {} in node {}",
                           labels.labels[voxel] == Label::v ? "v" : "h", labels.margins[voxel],
                           purity.n_in, purity.inlier == Label::v ? "v" : "h", node);
  return cause;
}

Cause cause_of(const Run& run, const TraceEvent& event, std::int32_t voxel) {
  Cause cause;
  if (event.type == EventType::decide) {
    const OctreeNode& node = run.octree().nodes[event.node];
    if (node.decided == Case::II) return too_few(run, event.node);
    if (node.at_max_depth) return at_greatest_depth(run, event.node);
    return outlier(run, event.node, voxel);
  }
  if (event.type == EventType::refine) {
    cause.text =
        plane_name(event.plane) + " was dropped (R2): larger planes explain it, or it is noise";
    cause.remedy = {"r2_explain_away = off would keep it", "r2_explain_away", "off"};
  } else if (event.stage == Stage::split_disconnected) {
    cause.text = plane_name(event.plane) + ", split off for not touching, has too few points";
    cause.remedy = {"split_disconnected = off would keep it", "split_disconnected", "off"};
  } else {
    cause.text = fmt::format(
        "the candidate of node {} waited (R3), found no partner, and its normal is known to "
        "{:.1f}° "
        "only",
        event.node, event.value * 180 / std::numbers::pi);
    cause.remedy = {
        fmt::format("r3_weak_candidates = off would let node {} found a plane", event.node),
        "r3_weak_candidates", "off"};
  }
  return cause;
}

WhyNot lost(const Run& run, std::int32_t voxel) {
  WhyNot why;
  if (!run.is_ours()) {
    why.answer = fmt::format("Lost: method {} has no plane for it, and leaves no trace of why",
                             to_string(run.options.method));
    return why;
  }
  const Loss loss = loss_of(run, voxel);
  if (loss.left == 0) {
    why.answer = "Lost: its plane has no point left";
    return why;
  }
  const TraceEvent& left = *run.event_at(loss.left);
  const Cause cause = cause_of(run, left, voxel);
  why.step = loss.left;
  why.node = left.node;
  why.plane = left.plane;
  why.remedy = cause.remedy;
  if (loss.dropped == 0) {
    why.answer = fmt::format("Lost at step {}: {}", loss.left, cause.text);
    return why;
  }
  const LeftoverReport leftover = explain_leftover(run, loss.dropped);
  if (cause.outlier) {
    why.step = loss.dropped;
    if (!leftover.planes.empty()) {
      const LeftoverPlane& nearest = leftover.planes.front();
      why.plane = nearest.plane;
      if (run.segment_options.leftover_rule == LeftoverRule::first)
        why.remedy = {fmt::format("leftover_distance_m >= {:.3g} would give it to {}",
                                  nearest.distance_m, plane_name(nearest.plane)),
                      "leftover_distance_m", rounded_up(nearest.distance_m)};
    }
    why.answer = fmt::format("Lost at step {}: {}, {}", loss.dropped, cause.text, leftover.outcome);
    return why;
  }
  why.answer = fmt::format("Lost at step {}: {}; left over, it ended {} (step {})", loss.left,
                           cause.text, leftover.outcome, loss.dropped);
  return why;
}

/// The first merge after which what became this plane of the result holds nodes of both true
/// planes; 0 if there is none.
std::int32_t step_of_fusion(const Run& run, std::int32_t id, std::int32_t own, std::int32_t most) {
  const auto ends_in = [&](std::int32_t plane) {
    const PlaneChange* last = run.timeline.plane_at(plane, run.steps());
    while (!last->alive && last->into >= 0) {
      plane = last->into;
      last = run.timeline.plane_at(plane, run.steps());
    }
    return run.timeline.result_of_plane(plane);
  };
  bool has_own = false, has_most = false;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const TraceEvent& event = *run.event_at(step);
    const bool joins = event.type == EventType::found || event.type == EventType::merge;
    if (!joins || event.node < 0 || ends_in(event.plane) != id) continue;
    const std::int32_t truth = run.facts[static_cast<std::size_t>(event.node)].truth_plane;
    if (truth != own && truth != most) continue;
    (truth == own ? has_own : has_most) = true;
    if (has_own && has_most) return event.type == EventType::merge ? step : 0;
  }
  return 0;
}

WhyNot in_a_plane(const Run& run, std::int32_t voxel) {
  const std::int32_t id = run.segmentation.plane_of[voxel];
  WhyNot why;
  why.step = step_of_plane(run, voxel);
  why.plane = run.segmentation.planes[id - 1].founded;
  if (const TraceEvent* event = run.event_at(why.step)) why.node = event->node;
  why.answer = "It is in " + describe_plane(run, id);
  if (run.is_ours()) why.answer += fmt::format(" since step {}", why.step);

  const VoxelTruth& truth = run.subject->voxel_truth;
  if (!truth.known() || truth.plane[voxel] < 0) return why;
  const std::int32_t own = truth.plane[voxel], most = truth_of_plane(run, id);
  if (own == most) {
    why.answer += fmt::format(", as it should: that is true plane {}", own);
    return why;
  }
  why.answer += own > 0 ? fmt::format(", but it belongs to true plane {}", own)
                        : std::string(", but it belongs to no plane");
  why.answer += fmt::format(", and most of that plane to {}", most);
  const std::int32_t merge = step_of_fusion(run, id, own, most);
  if (merge == 0) return why;
  why.step = merge;
  why.node = run.event_at(merge)->node;
  why.answer += fmt::format("; they were fused at step {}: {}", merge, describe_event(run, merge));
  if (!run.segment_options.r1_merge_by_distance.on)
    why.remedy = {fmt::format("merge_offset_m < {:.3g} would have kept node {} apart",
                              run.event_at(merge)->value, why.node),
                  "merge_offset_m", fmt::format("{:.2g}", 0.95 * run.event_at(merge)->value)};
  return why;
}

}  // namespace

WhyNot why_not(const Run& run, std::size_t source) {
  if (const std::optional<Absence> absence = absence_of(run, source)) {
    WhyNot why;
    why.answer = "It never came to the segmentation: " + absence->text;
    why.remedy = absence->remedy;
    return why;
  }
  const auto voxel = static_cast<std::int32_t>(run.subject->voxel_of_source(source));
  return run.segmentation.plane_of[voxel] > 0 ? in_a_plane(run, voxel) : lost(run, voxel);
}

}  // namespace planescope
