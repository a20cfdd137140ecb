// Events in words.

#include <fmt/format.h>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {
namespace {

constexpr double kMm = 1e3;
constexpr double kDegrees = 57.29577951308232;  // per radian

std::string decision(const Run& run, const planes::TraceEvent& event) {
  const NodeFacts& facts = run.facts[event.node];
  const planes::SegmentOptions& options = run.segment_options;
  const planes::Purity& purity = facts.purity;
  const auto decided = static_cast<planes::Case>(event.node_case);
  switch (decided) {
    case planes::Case::none:
      break;
    case planes::Case::I:
      if (purity.n_out > static_cast<std::uint32_t>(options.theta_n_out))
        return fmt::format("case I, N_out {} > {}", purity.n_out, options.theta_n_out);
      return fmt::format("case I, r_out {:.3g} > {:.3g}", purity.r_out(), options.theta_r_out);
    case planes::Case::II:
      return fmt::format("case II, N_in {} < {}", purity.n_in, options.theta_n_in);
    case planes::Case::III:
    case planes::Case::IV: {
      const char* op = decided == planes::Case::IV ? "≤" : ">";
      if (options.noise.rms_criterion3)
        return fmt::format("case {}, RMS {:.2f} {} {:.2f} mm", planes::to_string(decided),
                           facts.e_n * kMm, op, facts.theta_e_n * kMm);
      return fmt::format("case {}, e_n {:.3g} {} {:.3g} m²", planes::to_string(decided), facts.e_n,
                         op, facts.theta_e_n);
    }
  }
  return "not settled";
}

/// Who the event is about: "node 41 (h, 35 points)".
std::string candidate(const Run& run, const planes::TraceEvent& event) {
  const planes::OctreeNode& node = run.octree().nodes[event.node];
  if (event.label == Label::unknown)  // nobody knows gravity: all of the node's points
    return fmt::format("node {} ({} points)", event.node, node.size());
  const std::uint32_t h = run.segment_options.use_labels ? node.count_h : node.size();
  return fmt::format("node {} ({}, {} points)", event.node, to_string(event.label, "?"),
                     event.label == Label::h ? h : node.size() - h);
}

std::string refinement(const planes::TraceEvent& event) {
  return fmt::format(
      "{}: {}", planes::to_string(event.stage),
      fmt::format(fmt::runtime(planes::refinement_of(event.stage)->says),
                  fmt::arg("plane", plane_name(event.plane)),
                  fmt::arg("other", plane_name(event.other)), fmt::arg("point", event.point),
                  fmt::arg("mm", event.value * kMm)));
}

}  // namespace

std::string plane_name(std::int32_t plane) { return fmt::format("P{}", plane + 1); }

std::string describe_event(const Run& run, std::int32_t step) {
  const planes::TraceEvent* event = run.event_at(step);
  if (!event && !run.is_ours())
    return fmt::format("method {} leaves no trace of how it found its planes",
                       planes::to_string(run.options.method));
  if (!event) return "start: the root waits in the queue";
  const std::string plane = plane_name(event->plane);
  switch (event->type) {
    case planes::EventType::visit: {
      const planes::OctreeNode& node = run.octree().nodes[event->node];
      return fmt::format("node {} (depth {}): dequeued, {} points", event->node, node.depth,
                         node.size());
    }
    case planes::EventType::decide:
      return fmt::format("node {} (depth {}): {}", event->node,
                         run.octree().nodes[event->node].depth, decision(run, *event));
    case planes::EventType::found:
      if (event->node < 0)
        return fmt::format("{}: {} parts from {}: {}", planes::to_string(event->stage), plane,
                           plane_name(event->other),
                           planes::refinement_of(event->stage)->why_parted);
      return fmt::format("{} founds {}", candidate(run, *event), plane);
    case planes::EventType::merge:
      return fmt::format("{} joins {}, {:.1f} mm off it", candidate(run, *event), plane,
                         event->value * kMm);
    case planes::EventType::assign:
      return fmt::format("point {} goes to {}, {:.1f} mm off it", event->point, plane,
                         event->value * kMm);
    case planes::EventType::drop:
      if (event->value < 0)
        return fmt::format("point {} stays without a plane: none is near", event->point);
      return fmt::format("point {} stays without a plane: the nearest is {:.1f} mm off",
                         event->point, event->value * kMm);
    case planes::EventType::refine:
      return refinement(*event);
    case planes::EventType::wait:
      return fmt::format("{} waits: its normal is known to {:.1f}° only", candidate(run, *event),
                         event->value * kDegrees);
    case planes::EventType::leave:
      if (event->node < 0)
        return fmt::format("{}: {} has too few points, they are left over",
                           planes::to_string(event->stage), plane);
      return fmt::format("{} is left over: its normal is known to {:.1f}° only",
                         candidate(run, *event), event->value * kDegrees);
  }
  return {};
}

}  // namespace planescope::debug
