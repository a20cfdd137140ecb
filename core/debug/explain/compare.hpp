#pragma once

// Compares two runs of the same frame: where they diverge, and the resulting differences. Voxels,
// options, classifier and profile may differ. Nodes match by cell, points by pixel.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::debug {

struct NodeChange {
  std::int32_t a = -1, b = -1;  // node in each run; -1 if it does not exist there
  planes::Case case_a = planes::Case::none, case_b = planes::Case::none;
};

using planes::PlanePair;  // 0: no counterpart; over voxels or, if they differ, over sources

struct Comparison {
  std::int32_t diverging_step_a = planes::kNever,
               diverging_step_b = planes::kNever;  // first differing event
  std::string divergence;                          // one sentence
  std::vector<NodeChange> nodes;                   // settled differently, larger nodes first
  std::vector<PlanePair> planes;               // best matches first, then lost (b 0), gained (a 0)
  std::vector<std::uint32_t> changed_sources;  // points not on the matched plane
  std::size_t compared_sources = 0;
};
Comparison compare_runs(const Run& a, const Run& b);
/// Compares planes with ground truth; `a` of each pair is the true plane.
Comparison compare_with_truth(const Run& run);

/// Maps nodes, voxels and events of one run to those of another.
class Correspondence {
 public:
  Correspondence(const Run& from, const Run& to);

  bool same_voxels() const { return same_voxels_; }
  /// -1 if the cell is not a node of the other run, or if the octrees' cubes differ.
  std::int32_t node(std::int32_t node) const;
  /// Maps the voxel's first pixel; -1 if the other run cropped it.
  std::int32_t voxel(std::int32_t voxel) const { return same_voxels_ ? voxel : voxels_[voxel]; }
  /// Whether both are the same decision, ignoring plane indices and measured values.
  bool same_event(const planes::TraceEvent& from, const planes::TraceEvent& to) const;

 private:
  const Run& from_;
  const Run& to_;
  bool same_voxels_ = false;
  std::vector<std::int32_t> voxels_;  // empty if same_voxels_
};

/// The node of `other` with the same cell; -1 if none.
std::int32_t same_node(const Run& run, std::int32_t node, const Run& other);
/// The last step of `other` that corresponds to `step` of `run`: the event on the same node or
/// point, otherwise the same fraction of all steps.
std::int32_t same_step(const Run& run, std::int32_t step, const Run& other);

// The decision that explains the outcome for most points of a region. Decisions with the same event
// type, case and stage are of the same kind.

struct RegionDecision {
  std::int32_t step = 0;    // the decision that affects most points; 0: none
  std::int32_t voxel = -1;  // one of these points
  std::size_t points = 0;   // points of the region affected by decisions of this kind
  std::size_t alike = 0;    // number of decisions of this kind, including this one
};

/// The first decision of `run` on each point of the region that differs from `a`; `step` 0 if there
/// are no differences or no traces.
RegionDecision first_difference(const Run& run,
                                const Run& a,
                                std::span<const std::uint32_t> voxels);

/// The decision that left most of the region's unassigned points over.
RegionDecision loss_of_region(const Run& run, std::span<const std::uint32_t> voxels);

/// The merge that moved most of the region's points to their final plane or, without one, the
/// decision that assigned them individually.
RegionDecision joining_of_region(const Run& run, std::span<const std::uint32_t> voxels);

/// The plane of the result that contains most of the region; 0 if most of it is unassigned.
std::int32_t plane_of_region(const Run& run, std::span<const std::uint32_t> voxels);

}  // namespace planescope::debug
