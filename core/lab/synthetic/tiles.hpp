#pragma once

// Clouds of as many points or planes as one likes, for how times grow.

#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::lab {

struct PointsOnPlanes {
  std::vector<Vec3f> points;  // z up [m]
  std::vector<Label> labels;  // true
};

/// Level tiles, `side` along either side of a square of 5 m, each some centimetres above or below
/// its neighbours, with 2 mm of noise. Tiles are planes of their own but for the few whose
/// neighbour happens to be as high.
PointsOnPlanes tiles(int side, int points);

/// A staircase of the paper's set, points scattered evenly over it with 2 mm of noise: unlike
/// make_stairs(), in a time that grows with the points alone.
PointsOnPlanes scattered_stairs(int points);

}  // namespace planescope::lab
