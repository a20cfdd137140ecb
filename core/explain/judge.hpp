#pragma once

// Which decisions disagree with ground truth. Internal to core/explain.

#include "core/explain/bins.hpp"
#include "core/replay/run.hpp"

namespace planescope {

/// A node is settled wrongly where case IV takes points of several true planes for one, or I or III
/// divide what is one true plane.
Judgement judge_node(const Run& run, std::int32_t node);

/// Walks forward through the trace, with the true planes of each plane's points.
class TruthWalk {
 public:
  explicit TruthWalk(const Run& run);
  /// Judges the next found, merge, assign or drop event; unknown for others.
  /// A merge is wrong where its sides belong to different true planes, a founding where another
  /// plane holds that true plane already, a leftover point in a plane that is not its own or,
  /// though it has one, in none.
  Judgement next();

 private:
  std::vector<std::uint32_t> counts_of(const TraceEvent& candidate) const;
  Judgement judge(const TraceEvent& event, const std::vector<std::uint32_t>& part) const;

  const Run& run_;
  std::int32_t step_ = 0;
  std::vector<std::vector<std::uint32_t>> counts_;  // [plane of the trace][true plane]
};

}  // namespace planescope
