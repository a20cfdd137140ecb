#pragma once

// The one decision that explains what became of most points of a region. Decisions are of one kind
// where their event, case and stage are.

#include <cstdint>
#include <span>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

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
