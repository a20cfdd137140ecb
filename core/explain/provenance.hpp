#pragma once

// A point's whole life, and why a place ended in no plane.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/replay/run.hpp"

namespace planescope {

/// One station of a point's life. `step` -1: before the segmentation.
struct LifeEvent {
  std::string
      stage;  // "pixel", "voxel", "label", "node", "merge", "leftover", "refinement", "result"
  std::string text;  // "case III at depth 5: e_n 0.0071 m² > 0.005"
  std::int32_t step = -1;
  std::int32_t node = -1;
  std::int32_t plane = -1;
  bool decisive = false;  // the decision that lost it (or gave it its plane)
};

/// `source`: pixel v * width + u, or index in the cloud's file. Points that were never measured or
/// were cropped have a short life that says so.
std::vector<LifeEvent> life_of(const Run& run, std::size_t source);
/// A source of the voxel: the one nearest to its mean.
std::size_t source_of_voxel(const Subject& subject, std::uint32_t voxel);

/// What would have kept a point: all empty where nothing obvious would.
struct Remedy {
  std::string text;           // "theta_n_in <= 4 would ask for a plane in node 77"
  std::string option, value;  // the same as --set takes it
};
struct WhyNot {
  std::string answer;      // one sentence: "Lost at step 812: dropped, the nearest plane P4 is ..."
  std::int32_t step = -1;  // of the decision, -1 where it never came to the segmentation
  std::int32_t node = -1;
  std::int32_t plane = -1;
  Remedy remedy;
};
WhyNot why_not(const Run& run, std::size_t source);

}  // namespace planescope
