#pragma once

// How much of a scene's stairs a depth frame shows.

#include <string>
#include <vector>

#include "core/lab/synthetic/evaluation_sets.hpp"

namespace planescope::lab {

/// A step is seen where the tread behind its nosing has so many measured pixels, and the level
/// before it as many within one going of the nosing, and as wide as that.
inline constexpr int kSeenPixels = 500;
/// With so many it is seen for certain; with fewer than these nobody can see it.
inline constexpr int kSurelySeenPixels = 1000, kBarelySeenPixels = 100;

struct SeenStep {
  int tread_px = 0, before_px = 0;
  int least_px() const { return tread_px < before_px ? tread_px : before_px; }
};

/// Of each step of the frame's stairs, what was measured within a depth.
std::vector<SeenStep> seen_steps(const EvaluationFrame& frame, double max_range_m);

/// The most steps in sequence that have `least_px` of either.
int steps_in_sequence(const std::vector<SeenStep>& seen, int least_px);

/// The stairs of a set's frame, as JSON tells them.
struct ToldStairs {
  std::string frame;
  TrueStairs stairs;
  std::vector<SeenStep> seen;  // within max_range_m of depth
};
/// schema "planescope.true_stairs/1".
std::string true_stairs_json(const std::string& set,
                             const std::vector<ToldStairs>& frames,
                             double max_range_m);

}  // namespace planescope::lab
