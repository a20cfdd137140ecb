// Runs one frame with a trace, and computes the debugger's data.

#include "core/debug/replay/run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/model/text.hpp"
#include "core/planes/segment/criteria.hpp"

namespace planescope::debug {
namespace {

constexpr double kMm = 1e3;

std::string decision_on_image(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  const planes::Case decided = run.octree().nodes[node].decided;
  switch (decided) {
    case planes::Case::none:
      break;
    case planes::Case::I:
      if (facts.e_n >= planes::kNotFlat) return "case I, part of it is not flat";
      return fmt::format("case I, two planes cost {:.3g} > {:.3g}", facts.e_n, facts.theta_e_n);
    case planes::Case::II:
      if (facts.e_n >= facts.theta_e_n)
        return fmt::format("case II, {} are too few", counted(facts.purity.n_in, "point"));
      return fmt::format("case II, {:.3g} % filled < {:.3g} %", 100 * facts.e_n,
                         100 * facts.theta_e_n);
    case planes::Case::III:
    case planes::Case::IV:
      return fmt::format("case {}, variance {:.3g} {} {:.3g} times the expected",
                         planes::to_string(decided), facts.e_n,
                         decided == planes::Case::IV ? "≤" : ">", facts.theta_e_n);
  }
  return "undecided";
}

std::string decision_in_space(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  const planes::SegmentOptions& options = run.segment_options;
  const planes::Purity& purity = facts.purity;
  const planes::Case decided = run.octree().nodes[node].decided;
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
      if (options.by_objective())
        return fmt::format("case {}, RMS {:.2f} {} {:.2f} mm", planes::to_string(decided),
                           facts.e_n * kMm, op, facts.theta_e_n * kMm);
      return fmt::format("case {}, e_n {:.3g} {} {:.3g} m²", planes::to_string(decided), facts.e_n,
                         op, facts.theta_e_n);
    }
  }
  return "undecided";
}

/// The candidate of the event: "node 41 (h, 35 points)".
std::string candidate(const Run& run, const planes::TraceEvent& event) {
  const planes::OctreeNode& node = run.octree().nodes[event.node];
  if (event.label == Label::unknown || run.is_on_image())  // all points of the node
    return fmt::format("node {} ({})", event.node, counted(node.size(), "point"));
  const std::uint32_t h = run.segment_options.use_labels ? node.count_h : node.size();
  return fmt::format("node {} ({}, {})", event.node, to_string(event.label, "?"),
                     counted(event.label == Label::h ? h : node.size() - h, "point"));
}

std::string change(const Run& run, const planes::TraceEvent& event, std::int32_t step) {
  const planes::StageInfo& info = *planes::info_of(event.stage);
  const char* stage = planes::to_string(event.stage);
  if (event.stage == planes::Stage::grow && !run.timeline.plane_at(event.plane, step)->alive)
    return fmt::format("{}: {} ends: {}", stage, plane_name(run, event.plane),
                       filled_in(info.why_dropped, run, event));
  return fmt::format("{}: {}", stage, filled_in(info.event_text, run, event));
}

/// Counts the true planes of nodes, one node at a time.
class TruthCounter {
 public:
  TruthCounter(const planes::Octree& octree, const VoxelTruth& truth)
      : octree_(octree), truth_(truth), points_(truth.plane_count + 1, 0) {}

  void count(const planes::OctreeNode& node, NodeFacts& facts) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::int32_t plane = truth_.plane[octree_.order[i]];
      if (plane <= 0) continue;
      ++facts.truth_known;
      if (++points_[plane] == 1) seen_.push_back(plane);
    }
    facts.truth_planes = static_cast<std::uint32_t>(seen_.size());
    for (const std::int32_t plane : seen_) {
      const bool more = points_[plane] > facts.truth_points;
      if (more || (points_[plane] == facts.truth_points && plane < facts.truth_plane)) {
        facts.truth_plane = plane;
        facts.truth_points = points_[plane];
      }
    }
    for (const std::int32_t plane : seen_) points_[plane] = 0;
    seen_.clear();
  }

 private:
  const planes::Octree& octree_;
  const VoxelTruth& truth_;
  std::vector<std::uint32_t> points_;  // per true plane; all 0 between nodes
  std::vector<std::int32_t> seen_;
};

std::size_t source_count(const Frame& frame) {
  return frame.is_cloud() ? frame.cloud->points.size() : frame.depth.pixels();
}

VoxelTruth truth_by_voxel(const planes::PreparedFrame& prepared, const planes::SourceTruth& truth) {
  const planes::FrameTruth on_points = planes::truth_on_points(truth.values, prepared.cloud.source);
  VoxelTruth result;
  result.label = planes::vote_labels(prepared.voxels, on_points.label);
  result.plane = planes::vote_instances(prepared.voxels, on_points.instance);
  for (const std::int32_t plane : result.plane)
    result.plane_count = std::max(result.plane_count, plane);
  return result;
}

/// Threshold of the criterion that decides a case.
double threshold_of(planes::Case decided, const planes::ObjectiveOptions& options) {
  switch (decided) {
    case planes::Case::I:
      return options.two_planes * options.merge_cost;
    case planes::Case::II:
      return options.filled;
    default:
      return options.flat;
  }
}

std::vector<NodeFacts> facts_on_image(const Run& run) {
  const planes::Octree& octree = run.octree();
  const VoxelTruth& truth = run.subject->voxel_truth;
  TruthCounter counter(octree, truth);
  std::vector<NodeFacts> result(octree.nodes.size());
  for (const planes::TraceEvent& event : run.trace.events)
    if (event.type == planes::EventType::decide) result[event.node].e_n = event.value;
  // Children follow their parents, and together contain all of their points.
  std::vector<Moments> moments(octree.nodes.size());
  for (std::size_t n = octree.nodes.size(); n-- > 0;) {
    const planes::OctreeNode& node = octree.nodes[n];
    if (node.first_child < 0)
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        moments[n].add(octree.points[i].cast<double>());
    for (int k = 0; node.first_child >= 0 && k < node.child_count; ++k)
      moments[n] += moments[node.first_child + k];
    NodeFacts& facts = result[n];
    facts.purity = planes::purity_of(node, false, Label::unknown);
    facts.fit = fit_plane(moments[n]);
    facts.theta_e_n = threshold_of(node.decided, run.segment_options.objective);
    if (truth.known()) counter.count(node, facts);
  }
  return result;
}

/// Computes Run::facts; requires the segmentation.
std::vector<NodeFacts> facts_of(const Run& run) {
  if (run.is_on_image()) return facts_on_image(run);
  const planes::Octree& octree = run.octree();
  const planes::SegmentOptions& options = run.segment_options;
  const VoxelTruth& truth = run.subject->voxel_truth;
  TruthCounter counter(octree, truth);
  std::vector<NodeFacts> result;
  result.reserve(octree.nodes.size());
  for (const planes::OctreeNode& node : octree.nodes) {
    NodeFacts facts;
    facts.purity = planes::purity_of(node, options.use_labels, options.one_label);
    facts.fit = planes::fit_label(octree, static_cast<std::int32_t>(result.size()),
                                  facts.purity.inlier, options.use_labels)
                    .fit;
    const planes::Planarity planar = planes::planarity(facts.fit, run.segmentation.noise, options);
    facts.e_n = planar.value;
    facts.theta_e_n = planar.threshold;
    if (truth.known()) counter.count(node, facts);
    result.push_back(facts);
  }
  return result;
}

}  // namespace

std::int32_t node_at_step(const Run& run, std::int32_t step) {
  const planes::TraceEvent* event = run.event_at(step);
  if (event == nullptr) return -1;
  if (event->node >= 0) return event->node;
  if (event->point >= 0) return run.timeline.node_of_point(event->point, step);
  for (std::int32_t k = 1; k <= step && event->plane >= 0; ++k)
    if (const planes::TraceEvent* founding = run.event_at(k);
        founding->type == planes::EventType::found && founding->plane == event->plane)
      return founding->node;
  return -1;
}

std::string decision_text(const Run& run, std::int32_t node) {
  return run.is_on_image() ? decision_on_image(run, node) : decision_in_space(run, node);
}

std::string plane_name(const Run& run, std::int32_t plane) {
  return plane < 0 ? "-" : fmt::format("P{}", run.timeline.number_of_plane(plane));
}

std::string filled_in(const char* text, const Run& run, const planes::TraceEvent& event) {
  return fmt::format(fmt::runtime(text), fmt::arg("plane", plane_name(run, event.plane)),
                     fmt::arg("other", plane_name(run, event.other)),
                     fmt::arg("point", event.point), fmt::arg("value", event.value),
                     fmt::arg("mm", event.value * kMm));
}

std::string describe_event(const Run& run, std::int32_t step) {
  const planes::TraceEvent* event = run.event_at(step);
  if (!event && !run.is_ours())
    return fmt::format("method {} records no steps", planes::to_string(run.options.method));
  if (!event) return "start: the root is queued";
  const std::string plane = plane_name(run, event->plane);
  switch (event->type) {
    case planes::EventType::visit: {
      const planes::OctreeNode& node = run.octree().nodes[event->node];
      return fmt::format("node {} (depth {}): dequeued, {}", event->node, node.depth,
                         counted(node.size(), "point"));
    }
    case planes::EventType::decide:
      return fmt::format("node {} (depth {}): {}", event->node,
                         run.octree().nodes[event->node].depth, decision_text(run, event->node));
    case planes::EventType::found:
      if (event->node < 0)
        return fmt::format("{}: {} split from {}: {}", planes::to_string(event->stage), plane,
                           plane_name(run, event->other),
                           planes::info_of(event->stage)->why_parted);
      return fmt::format("{} creates {}", candidate(run, *event), plane);
    case planes::EventType::merge:
      return fmt::format("{} merged into {}, {:.1f} mm away", candidate(run, *event), plane,
                         event->value * kMm);
    case planes::EventType::assign:
      return fmt::format("point {} assigned to {}, {:.1f} mm away", event->point, plane,
                         event->value * kMm);
    case planes::EventType::drop:
      if (event->value < 0)
        return fmt::format("point {} unassigned: no plane nearby", event->point);
      return fmt::format("point {} unassigned: the nearest plane is {:.1f} mm away", event->point,
                         event->value * kMm);
    case planes::EventType::refine:
      return change(run, *event, step);
  }
  return {};
}

std::uint32_t Subject::voxel_of_source(std::size_t source) const {
  if (source >= point_of_source.size()) return planes::kNoVoxel;
  const std::uint32_t point = point_of_source[source];
  return point == planes::kNoVoxel ? planes::kNoVoxel : prepared.voxels.voxel_of[point];
}

std::vector<std::uint32_t> Subject::voxels_of_sources(
    std::span<const std::uint32_t> sources) const {
  std::vector<std::uint32_t> voxels;
  for (const std::uint32_t source : sources)
    if (const std::uint32_t voxel = voxel_of_source(source); voxel != planes::kNoVoxel)
      voxels.push_back(voxel);
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

std::shared_ptr<const Subject> make_subject(Frame frame,
                                            std::optional<planes::SourceTruth> truth,
                                            const planes::PipelineOptions& options,
                                            const planes::Classifier* classifier) {
  auto subject = std::make_shared<Subject>();
  std::optional<planes::FrameTruth> on_points;
  if (truth) on_points = planes::truth_on_points(truth->values, planes::measured_sources(frame));
  subject->prepared =
      planes::prepare_frame(frame, options, classifier, on_points ? &*on_points : nullptr);

  const std::vector<std::uint32_t>& source = subject->prepared.cloud.source;
  subject->point_of_source.assign(source_count(frame), planes::kNoVoxel);
  for (std::size_t i = 0; i < source.size(); ++i)
    subject->point_of_source[source[i]] = static_cast<std::uint32_t>(i);
  if (truth) subject->voxel_truth = truth_by_voxel(subject->prepared, *truth);
  subject->frame = std::move(frame);
  subject->truth = std::move(truth);
  return subject;
}

std::shared_ptr<const Run> make_run(std::shared_ptr<const Subject> subject,
                                    const planes::PipelineOptions& options) {
  auto run = std::make_shared<Run>();
  const planes::PreparedFrame& prepared = subject->prepared;
  run->subject = std::move(subject);
  run->options = options;
  run->segment_options = planes::segment_options(prepared, options);
  planes::FoundRegions found =
      planes::find_regions(run->subject->frame, prepared, options, &run->trace);
  run->segmentation = std::move(found.segmentation);
  run->plane_of = std::move(found.plane_of);
  if (run->is_on_image()) run->segment_options.use_labels = false;
  run->timeline = run->is_ours() ? Timeline(run->trace, run->segmentation)
                                 : Timeline(run->segmentation, prepared.voxels.points);
  run->facts = facts_of(*run);
  run->wrong = wrong_decisions(*run);
  return run;
}

}  // namespace planescope::debug
