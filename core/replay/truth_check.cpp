#include "core/replay/truth_check.hpp"

#include <algorithm>
#include <utility>

namespace planescope {
namespace {

/// How many points of each true plane a plane of the trace has.
class TruthTally {
 public:
  void add(std::int32_t truth, std::uint32_t points = 1) {
    const auto known = std::find_if(counts_.begin(), counts_.end(),
                                    [&](const auto& entry) { return entry.first == truth; });
    const auto entry = known != counts_.end() ? known : counts_.insert(known, {truth, 0});
    entry->second += points;
    if (entry->second > most_) {
      most_ = entry->second;
      majority_ = truth;
    }
  }
  void add(const TruthTally& other) {
    for (const auto& [truth, points] : other.counts_) add(truth, points);
  }
  std::int32_t majority() const { return majority_; }  // 0 where there is none

 private:
  std::vector<std::pair<std::int32_t, std::uint32_t>> counts_;
  std::uint32_t most_ = 0;
  std::int32_t majority_ = 0;
};

class TruthChecker {
 public:
  explicit TruthChecker(const Run& run) : run_(run) {}

  bool is_wrong(const TraceEvent& event) {
    switch (event.type) {
      case EventType::decide:
        return is_wrong_case(event);
      case EventType::found: {
        if (event.refinement == kSplit) {
          planes_.push_back({});
          return false;
        }
        const TruthTally tally = tally_of(event);
        const bool doubled = tally.majority() > 0 && stands_already(tally.majority());
        planes_.push_back({tally, true});
        return doubled;
      }
      case EventType::merge: {
        const TruthTally tally = tally_of(event);
        const bool differs = differ(tally.majority(), event.plane);
        planes_[event.plane].tally.add(tally);
        return differs;
      }
      case EventType::assign: {
        const std::int32_t truth = truth_of(event.point);
        const bool differs = differ(truth, event.plane);
        if (truth > 0) planes_[event.plane].tally.add(truth);
        return differs;
      }
      case EventType::drop:
        return truth_of(event.point) > 0;
      case EventType::refine:
        if (event.refinement == 7) planes_[event.other].tally.add(planes_[event.plane].tally);
        if (event.refinement == 7 || event.refinement == 2) planes_[event.plane].alive = false;
        return false;
      default:
        return false;
    }
  }

 private:
  struct Plane {
    TruthTally tally;
    bool alive = true;
  };

  bool is_wrong_case(const TraceEvent& event) const {
    const NodeFacts& facts = run_.facts[event.node];
    switch (static_cast<Case>(event.node_case)) {
      case Case::I:
      case Case::III:
        return is_pure_in_truth(facts, run_.segment_options);
      case Case::IV:
        return is_mixed_in_truth(facts, run_.segment_options);
      default:
        return false;
    }
  }

  TruthTally tally_of(const TraceEvent& event) const {
    const Octree& octree = run_.octree();
    const OctreeNode& node = octree.nodes[event.node];
    TruthTally tally;
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (run_.segment_options.use_labels && octree.labels[i] != event.label) continue;
      const std::int32_t truth = truth_of(static_cast<std::int32_t>(octree.order[i]));
      if (truth > 0) tally.add(truth);
    }
    return tally;
  }

  std::int32_t truth_of(std::int32_t point) const { return run_.subject->voxel_truth.plane[point]; }

  bool stands_already(std::int32_t truth) const {
    return std::any_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
      return plane.alive && plane.tally.majority() == truth;
    });
  }
  bool differ(std::int32_t truth, std::int32_t plane) const {
    const std::int32_t majority = planes_[plane].tally.majority();
    return truth > 0 && majority > 0 && truth != majority;
  }

  const Run& run_;
  std::vector<Plane> planes_;
};

}  // namespace

bool is_mixed_in_truth(const NodeFacts& facts, const SegmentOptions& options) {
  return !is_pure({.n_in = facts.truth_points, .n_out = facts.truth_known - facts.truth_points},
                  options);
}

bool is_pure_in_truth(const NodeFacts& facts, const SegmentOptions& options) {
  const std::uint32_t size = facts.purity.n_in + facts.purity.n_out;
  return is_pure({.n_in = facts.truth_points, .n_out = size - facts.truth_points}, options) &&
         has_enough_inliers(facts.truth_points, options);
}

std::vector<std::uint8_t> wrong_decisions(const Run& run) {
  std::vector<std::uint8_t> wrong;
  if (!run.subject->voxel_truth.known()) return wrong;
  wrong.reserve(run.trace.events.size());
  TruthChecker checker(run);
  for (const TraceEvent& event : run.trace.events) wrong.push_back(checker.is_wrong(event));
  return wrong;
}

}  // namespace planescope
