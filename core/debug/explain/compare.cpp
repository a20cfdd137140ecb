// Compares two runs of a frame, or a run and ground truth: planes, nodes and points that differ,
// and the first differing event.

#include "core/debug/explain/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "core/debug/explain/provenance.hpp"
#include "core/debug/explain/score.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::debug {
namespace {

std::vector<std::int32_t> voxels_by_source(const Subject& from, const Subject& to) {
  std::vector<std::int32_t> voxels(from.voxel_count(), -1);
  const std::vector<std::uint32_t>& voxel_of = from.prepared.voxels.voxel_of;
  for (std::size_t i = voxel_of.size(); i-- > 0;) {  // the first source wins
    if (voxel_of[i] == planes::kNoVoxel) continue;
    const std::uint32_t other = to.voxel_of_source(from.prepared.cloud.source[i]);
    if (other != planes::kNoVoxel) voxels[voxel_of[i]] = static_cast<std::int32_t>(other);
  }
  return voxels;
}

/// The step of the last event of `to` that corresponds to `event`; 0 if none.
std::int32_t step_of(const Correspondence& same, const planes::TraceEvent& event, const Run& to) {
  for (std::int32_t step = to.steps(); step > 0; --step)
    if (same.same_event(event, *to.event_at(step))) return step;
  return 0;
}

/// The step at which the other run settled the node or its nearest ancestor that exists there.
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

/// Matched planes first, then planes without a counterpart.
std::vector<PlanePair> match_planes(const planes::TruthOverlap& overlap) {
  std::vector<PlanePair> pairs = planes::pairs_by_overlap(overlap);
  std::vector<std::uint8_t> matched_a(overlap.truth + 1, 0), matched_b(overlap.found + 1, 0);
  for (const PlanePair& pair : pairs) matched_a[pair.a] = matched_b[pair.b] = 1;
  for (int a = 1; a <= overlap.truth; ++a)
    if (!matched_a[a] && overlap.truth_size[a] > 0) pairs.push_back({a, 0, 0});
  for (int b = 1; b <= overlap.found; ++b)
    if (!matched_b[b] && overlap.found_size[b] > 0) pairs.push_back({0, b, 0});
  return pairs;
}

using Planes = std::vector<std::int32_t>;  // per voxel or source; 0 none, -1 not compared

Planes by_source(const Subject& subject, const Planes& by_voxel) {
  Planes planes;
  for (std::size_t i = 0; i < subject.point_of_source.size(); ++i) {
    const std::uint32_t voxel = subject.voxel_of_source(i);
    planes.push_back(voxel == planes::kNoVoxel ? -1 : by_voxel[voxel]);
  }
  return planes;
}

/// Finds the sources whose plane in b is not the counterpart of their plane in a.
void compare_sources(const Planes& a, const Planes& b, int count_a, Comparison& result) {
  Planes counterpart(count_a + 1, -1);
  counterpart[0] = 0;
  for (const PlanePair& pair : result.planes)
    if (pair.a > 0 && pair.b > 0) counterpart[pair.a] = pair.b;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < 0) continue;
    ++result.compared_sources;
    if (b[i] != counterpart[a[i]]) result.changed_sources.push_back(static_cast<std::uint32_t>(i));
  }
}

void find_divergence(const Run& a, const Run& b, const Correspondence& same, Comparison& result) {
  const auto parting =
      std::ranges::mismatch(a.trace.events, b.trace.events,
                            [&](const auto& x, const auto& y) { return same.same_event(x, y); });
  const auto step = static_cast<std::int32_t>(parting.in1 - a.trace.events.begin()) + 1;
  if (step > a.steps() && step > b.steps()) {
    result.divergence = "identical in all events";
    return;
  }
  const auto event_text = [step](const Run& run) {
    return step <= run.steps() ? describe_event(run, step) : std::string("the end");
  };
  if (step <= a.steps()) result.diverging_step_a = step;
  if (step <= b.steps()) result.diverging_step_b = step;
  result.divergence =
      fmt::format("step {}: A has {}; B has {}", step, event_text(a), event_text(b));
}

void compare_nodes(const Run& a, const Run& b, const Correspondence& to_b, Comparison& result) {
  const Correspondence to_a(b, a);
  const auto& nodes_a = a.octree().nodes;
  const auto& nodes_b = b.octree().nodes;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_a.size()); ++n) {
    const std::int32_t other = to_b.node(n);
    const planes::Case there = other >= 0 ? nodes_b[other].decided : planes::Case::none;
    if (nodes_a[n].decided != there) result.nodes.push_back({n, other, nodes_a[n].decided, there});
  }
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_b.size()); ++n)
    if (to_a.node(n) < 0) result.nodes.push_back({-1, n, planes::Case::none, nodes_b[n].decided});

  const auto key = [&](const NodeChange& change) {
    const planes::OctreeNode& node = change.a >= 0 ? nodes_a[change.a] : nodes_b[change.b];
    return std::tuple(node.depth, -static_cast<std::int64_t>(node.size()), node.code);
  };
  std::ranges::stable_sort(result.nodes, {}, key);
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
  if (octree.nodes.empty() || !planes::same_cells(from_.octree(), octree)) return -1;
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

Comparison compare_runs(const Run& a, const Run& b) {
  Comparison result;
  const Correspondence same(a, b);
  if (a.is_ours() && b.is_ours()) {
    find_divergence(a, b, same, result);
    compare_nodes(a, b, same, result);
  } else {
    result.divergence =
        fmt::format("A uses {}, B uses {}: comparing planes only, because not both have steps",
                    planes::to_string(a.options.method), planes::to_string(b.options.method));
  }

  Planes sources_a = by_source(*a.subject, a.segmentation.plane_of);
  Planes sources_b = by_source(*b.subject, b.segmentation.plane_of);
  sources_a.resize(std::min(sources_a.size(), sources_b.size()));
  sources_b.resize(sources_a.size());
  for (std::size_t i = 0; i < sources_a.size(); ++i)
    if (sources_b[i] < 0) sources_a[i] = -1;  // cropped in one of them
  result.planes =
      match_planes(same.same_voxels() ? planes::count_truth_overlap(a.segmentation.plane_of,
                                                                    b.segmentation.plane_of)
                                      : planes::count_truth_overlap(sources_a, sources_b));
  compare_sources(sources_a, sources_b, static_cast<int>(a.segmentation.planes.size()), result);
  return result;
}

Comparison compare_with_truth(const Run& run) {
  Comparison result;
  const Subject& subject = *run.subject;
  const VoxelTruth& truth = subject.voxel_truth;
  if (!truth.known()) return result;
  const Planes& found = run.segmentation.plane_of;
  result.planes = match_planes(planes::count_truth_overlap(truth.plane, found));
  compare_sources(by_source(subject, truth.plane), by_source(subject, found), truth.plane_count,
                  result);
  return result;
}

// ---- Regions ----

namespace {

/// Counts points per decision. A plane is seldom lost in a single step, so the winner is the
/// decision with most points among the kind of decision with most points.
class Ballot {
 public:
  explicit Ballot(const Run& run) : run_(run) {}
  void vote(std::int32_t step, std::uint32_t voxel) {
    if (step <= 0) return;
    const planes::TraceEvent& event = *run_.event_at(step);
    Kind& kind =
        kinds_[{static_cast<int>(event.type), event.node_case, static_cast<int>(event.stage)}];
    ++kind.points;
    Step& votes = kind.steps[step];
    if (votes.points++ == 0) votes.voxel = static_cast<std::int32_t>(voxel);
  }
  /// The earliest decision on ties.
  RegionDecision winner() const {
    if (kinds_.empty()) return {};
    const auto points = [](const auto& entry) { return entry.second.points; };
    const Kind& kind = std::ranges::max_element(kinds_, {}, points)->second;
    const auto& [step, votes] = *std::ranges::max_element(kind.steps, {}, points);
    return {step, votes.voxel, kind.points, kind.steps.size()};
  }

 private:
  struct Step {
    std::size_t points = 0;
    std::int32_t voxel = -1;
  };
  struct Kind {
    std::size_t points = 0;
    std::map<std::int32_t, Step> steps;
  };
  const Run& run_;
  std::map<std::tuple<int, int, int>, Kind> kinds_;  // by type, case and stage
};

const planes::TraceEvent& founding_of(const Run& run, std::int32_t plane) {
  return *run.event_at(run.timeline.changes_of_plane(plane).front().step);
}

/// Finds the first difference between two runs. Planes are the same if they were created by the
/// same event.
class Parting {
 public:
  Parting(const Run& a, const Run& b) : a_(a), b_(b), to_b_(a, b), to_a_(b, a) {}

  /// First step of b in the voxel's history that differs from its history in a; 0 if none.
  std::int32_t step_of(std::uint32_t voxel_of_b) const {
    const auto in_b = static_cast<std::int32_t>(voxel_of_b), in_a = to_a_.voxel(in_b);
    if (in_a < 0) return 0;
    const std::set<std::int32_t> history_a = steps_of_point(a_, in_a),
                                 history_b = steps_of_point(b_, in_b);
    const auto alike = [this](std::int32_t step_a, std::int32_t step_b) {
      return are_alike(*a_.event_at(step_a), *b_.event_at(step_b));
    };
    const auto at_b = std::ranges::mismatch(history_a, history_b, alike).in2;
    return at_b == history_b.end() ? 0 : *at_b;
  }

 private:
  bool are_alike(const planes::TraceEvent& a, const planes::TraceEvent& b) const {
    const bool of_planes = a.node < 0 && a.point < 0;
    const bool same = of_planes
                          ? a.type == b.type && a.stage == b.stage && b.node < 0 && b.point < 0
                          : to_b_.same_event(a, b);
    return same && (a.plane < 0) == (b.plane < 0) && (a.plane < 0 || same_plane(a.plane, b.plane));
  }
  bool same_plane(std::int32_t plane_a, std::int32_t plane_b) const {
    const planes::TraceEvent& a = founding_of(a_, plane_a);
    // For parts split from a plane, compare indices: nothing else distinguishes them.
    return to_b_.same_event(a, founding_of(b_, plane_b)) && (a.node >= 0 || plane_a == plane_b);
  }

  const Run& a_;
  const Run& b_;
  Correspondence to_b_, to_a_;
};

}  // namespace

RegionDecision first_difference(const Run& run,
                                const Run& a,
                                std::span<const std::uint32_t> voxels) {
  if (!run.is_ours() || !a.is_ours()) return {};
  const Parting parting(a, run);
  Ballot ballot(run);
  for (const std::uint32_t voxel : voxels) ballot.vote(parting.step_of(voxel), voxel);
  return ballot.winner();
}

RegionDecision loss_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  Ballot ballot(run);
  if (run.is_ours())
    for (const std::uint32_t voxel : voxels)
      if (run.segmentation.plane_of[voxel] == 0)
        ballot.vote(loss_of(run, static_cast<std::int32_t>(voxel)).left, voxel);
  return ballot.winner();
}

RegionDecision joining_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  Ballot merges(run), single(run);
  if (run.is_ours())
    for (const std::uint32_t voxel : voxels) {
      const std::int32_t step = step_of_plane(run, static_cast<std::int32_t>(voxel));
      if (step == 0 || run.event_at(step)->type == planes::EventType::found) continue;
      (run.event_at(step)->point < 0 ? merges : single).vote(step, voxel);
    }
  const RegionDecision merge = merges.winner();
  return merge.step > 0 ? merge : single.winner();
}

std::int32_t plane_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  std::vector<std::int32_t> planes;
  for (const std::uint32_t voxel : voxels) planes.push_back(run.segmentation.plane_of[voxel]);
  const std::int32_t most = most_common_plane(planes);
  return 2 * std::ranges::count(planes, most) > std::ssize(planes) ? most : 0;
}

}  // namespace planescope::debug
