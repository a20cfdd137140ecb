#pragma once

// How much of a frame is on planes, and what became of the rest.

#include <cstdint>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Points that are in no plane for one reason.
struct Lost {
  std::string reason;                 // "worth too little"
  std::size_t sources = 0;            // pixels, or points of the file
  std::vector<std::uint32_t> voxels;  // ascending; empty where they are cropped
  std::int64_t middle = -1;           // a voxel in the midst of the most that one decision lost
};

struct FrameSummary {
  std::size_t measured = 0;      // pixels, or points of the file
  std::size_t out_of_range = 0;  // outside the octree's cube, or without a voxel
  std::size_t beyond = 0;        // of these, farther than max_range_m; depth images only
  std::size_t on_planes = 0;
  std::size_t on_undecided = 0;  // of these, on planes that are undecided
  int planes = 0, undecided = 0;
  std::vector<Lost> lost;  // the most first

  double share(std::size_t sources) const {
    return measured > 0 ? static_cast<double>(sources) / static_cast<double>(measured) : 0;
  }
};

FrameSummary summary_of(const Run& run);

}  // namespace planescope::debug
