// Checks decisions against ground truth.

#include <algorithm>
#include <utility>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {
namespace {

/// Points of each true plane in a plane of the trace.
class TruthTally {
 public:
  void add(std::int32_t truth, int points = 1) {
    const int now = of(truth) += points;
    if (now > of(majority_)) majority_ = truth;
    if (points >= 0 || truth != majority_) return;
    const auto most = std::ranges::max_element(counts_, {}, &Count::second);
    majority_ = most->second > 0 ? most->first : 0;
  }
  void add(const TruthTally& other) {
    for (const auto& [truth, points] : other.counts_) add(truth, points);
  }
  /// The true plane with most points, the first to reach that number on ties; 0 if none.
  std::int32_t majority() const { return majority_; }

 private:
  using Count = std::pair<std::int32_t, int>;  // true plane, points

  int& of(std::int32_t truth) {
    const auto known = std::ranges::find(counts_, truth, &Count::first);
    return known != counts_.end() ? known->second : counts_.emplace_back(truth, 0).second;
  }

  std::vector<Count> counts_{{0, 0}};
  std::int32_t majority_ = 0;
};

/// Checks each event against the planes at that time.
class TruthChecker {
 public:
  explicit TruthChecker(const Run& run)
      : run_(run),
        plane_of_(run.octree().order.size(), -1),
        tallies_(static_cast<std::size_t>(run.timeline.plane_count())) {}

  bool is_wrong(std::int32_t step) {
    const planes::TraceEvent& event = *run_.event_at(step);
    apply_changes_until(step - 1);
    switch (event.type) {
      case planes::EventType::decide:
        return is_wrong_case(event);
      case planes::EventType::found:
        // With the objective, cells create regions that join later.
        return event.node >= 0 && !run_.segment_options.by_objective() &&
               stands_already(truth_of_candidate(event), step - 1);
      case planes::EventType::merge:
        return differ(truth_of_candidate(event), event.plane);
      case planes::EventType::assign:
        return differ(truth_of(event.point), event.plane);
      case planes::EventType::drop:
        return truth_of(event.point) > 0;
      case planes::EventType::refine:
        return is_wrong_change(event, step);
      default:
        return false;
    }
  }

 private:
  void apply_changes_until(std::int32_t step) {
    const std::vector<planes::Trace::Point>& changes = run_.trace.points;
    while (applied_ < changes.size() && changes[applied_].change.step <= step) {
      // All points that one event gives to a plane are added together.
      const planes::PointChange first = changes[applied_].change;
      TruthTally given;
      apply_joins_until(first.step - 1);
      for (; applied_ < changes.size() && changes[applied_].change.step == first.step &&
             changes[applied_].change.plane == first.plane;
           ++applied_) {
        const std::uint32_t i = changes[applied_].point;
        const std::int32_t truth = truth_of(static_cast<std::int32_t>(run_.octree().order[i]));
        if (truth > 0 && plane_of_[i] >= 0)
          tallies_[run_.timeline.joined_plane(plane_of_[i], first.step - 1)].add(truth, -1);
        if (truth > 0) given.add(truth);
        plane_of_[i] = first.plane;
      }
      if (first.plane >= 0) tallies_[first.plane].add(given);
    }
    apply_joins_until(step);
  }
  /// Planes of an image join along with their points, without point changes.
  void apply_joins_until(std::int32_t step) {
    const std::vector<planes::Trace::Plane>& changes = run_.trace.planes;
    for (; joined_ < changes.size() && changes[joined_].change.step <= step; ++joined_)
      if (const planes::PlaneChange& change = changes[joined_].change;
          run_.is_on_image() && change.into >= 0)
        tallies_[change.into].add(tallies_[changes[joined_].plane]);
  }

  bool is_wrong_case(const planes::TraceEvent& event) const {
    const NodeFacts& facts = run_.facts[event.node];
    switch (static_cast<planes::Case>(event.node_case)) {
      case planes::Case::I:
      case planes::Case::III:
        return is_pure_in_truth(facts, run_.segment_options);
      case planes::Case::IV:
        return is_mixed_in_truth(facts, run_.segment_options);
      default:
        return false;
    }
  }

  /// On depth images: two true planes are joined, or a true plane is dropped.
  bool is_wrong_change(const planes::TraceEvent& event, std::int32_t step) const {
    if (event.stage == planes::Stage::join || event.stage == planes::Stage::hidden)
      return differ(tallies_[event.plane].majority(), event.other);
    if (event.stage != planes::Stage::list) return false;
    const std::int32_t truth = tallies_[event.plane].majority();
    return truth > 0 && !stands_already(truth, step);
  }

  std::int32_t truth_of_candidate(const planes::TraceEvent& event) const {
    const planes::Octree& octree = run_.octree();
    const planes::OctreeNode& node = octree.nodes[event.node];
    TruthTally tally;
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (run_.segment_options.use_labels && octree.labels[i] != event.label) continue;
      const std::int32_t truth = truth_of(static_cast<std::int32_t>(octree.order[i]));
      if (truth > 0) tally.add(truth);
    }
    return tally.majority();
  }

  std::int32_t truth_of(std::int32_t point) const { return run_.subject->voxel_truth.plane[point]; }

  bool stands_already(std::int32_t truth, std::int32_t step) const {
    for (std::int32_t k = 0; truth > 0 && k < run_.timeline.plane_count(); ++k) {
      const planes::PlaneChange* plane = run_.timeline.plane_at(k, step);
      if (!plane) break;  // the remaining planes are created later
      if (tallies_[k].majority() == truth && plane->alive) return true;
    }
    return false;
  }
  bool differ(std::int32_t truth, std::int32_t plane) const {
    const std::int32_t majority = tallies_[plane].majority();
    return truth > 0 && majority > 0 && truth != majority;
  }

  const Run& run_;
  std::size_t applied_ = 0, joined_ = 0;  // number of applied changes of points, of planes
  std::vector<std::int32_t> plane_of_;    // per Morton-ordered point
  std::vector<TruthTally> tallies_;       // per plane of the trace
};

}  // namespace

bool is_mixed_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options) {
  return !planes::is_pure(
      {.n_in = facts.truth_points, .n_out = facts.truth_known - facts.truth_points}, options);
}

bool is_pure_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options) {
  const std::uint32_t size = facts.purity.n_in + facts.purity.n_out;
  return planes::is_pure({.n_in = facts.truth_points, .n_out = size - facts.truth_points},
                         options) &&
         planes::has_enough_inliers(facts.truth_points, options);
}

std::vector<std::uint8_t> wrong_decisions(const Run& run) {
  std::vector<std::uint8_t> wrong;
  if (!run.subject->voxel_truth.known()) return wrong;
  wrong.reserve(run.trace.events.size());
  TruthChecker checker(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step) wrong.push_back(checker.is_wrong(step));
  return wrong;
}

}  // namespace planescope::debug
