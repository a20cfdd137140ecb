#pragma once

// Two runs side by side: where they diverge, and what follows from it. Of the same frame; voxels,
// options, classifier and profile may differ. Nodes are the same where their cells are, points
// where their pixels are.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::debug {

struct NodeChange {
  std::int32_t a = -1, b = -1;  // node in each run; -1 where it does not exist there
  planes::Case case_a = planes::Case::none, case_b = planes::Case::none;
};

using planes::PlanePair;  // 0: no counterpart; over voxels or, where they differ, over sources

struct Comparison {
  std::int32_t diverging_step_a = planes::kNever,
               diverging_step_b = planes::kNever;  // first differing event
  std::string divergence;                          // one sentence
  std::vector<NodeChange> nodes;                   // settled otherwise, larger nodes first
  std::vector<PlanePair> planes;               // matched best first, then lost (b 0), gained (a 0)
  std::vector<std::uint32_t> changed_sources;  // points whose plane is not the matched one
  std::size_t compared_sources = 0;
};
Comparison compare_runs(const Run& a, const Run& b);
/// Against ground truth: planes only. `a` of the pairs is the truth plane.
Comparison compare_with_truth(const Run& run);

/// Maps nodes, voxels and events of one run to those of another.
class Correspondence {
 public:
  Correspondence(const Run& from, const Run& to);

  bool same_voxels() const { return same_voxels_; }
  /// -1 where the cell is not a node of the other run, or the octrees' cubes differ.
  std::int32_t node(std::int32_t node) const;
  /// Of the voxel's first pixel; -1 where the other run cropped that.
  std::int32_t voxel(std::int32_t voxel) const { return same_voxels_ ? voxel : voxels_[voxel]; }
  /// Whether both are the same decision, apart from planes' numbers and measured values.
  bool same_event(const planes::TraceEvent& from, const planes::TraceEvent& to) const;

 private:
  const Run& from_;
  const Run& to_;
  bool same_voxels_ = false;
  std::vector<std::int32_t> voxels_;  // empty where they are the same
};

/// The node of `other` with the same cell, -1 where it has none.
std::int32_t same_node(const Run& run, std::int32_t node, const Run& other);
/// The last step of `other` at which its state corresponds to `step` of `run`: the event on the
/// same node or point; otherwise the same fraction of all steps.
std::int32_t same_step(const Run& run, std::int32_t step, const Run& other);

// The one decision that explains what became of most points of a region. Decisions are of one kind
// where their event, case and stage are.

struct RegionDecision {
  std::int32_t step = 0;    // the one about the most points; 0: there is none
  std::int32_t voxel = -1;  // one of these points
  std::size_t points = 0;   // of the region, that this or another decision of its kind is about
  std::size_t alike = 0;    // how many of its kind there are, itself included
};

/// Where `run` first decided otherwise on each point of the region than `a` did; `step` 0 where
/// both decide alike, or leave no trace.
RegionDecision first_difference(const Run& run,
                                const Run& a,
                                std::span<const std::uint32_t> voxels);

/// The decision that left most of the region's points over, of those that no plane has.
RegionDecision loss_of_region(const Run& run, std::span<const std::uint32_t> voxels);

/// The merge that brought most of the region's points to where they end; without one, what brought
/// them there point by point.
RegionDecision joining_of_region(const Run& run, std::span<const std::uint32_t> voxels);

/// The plane of the result that most of the region is in, 0 where most of it is in none.
std::int32_t plane_of_region(const Run& run, std::span<const std::uint32_t> voxels);

}  // namespace planescope::debug
