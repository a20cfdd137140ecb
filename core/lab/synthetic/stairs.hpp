#pragma once

// The paper's evaluation set (Sec. V): stairs of random size, a tread and a riser per step. The
// noise is added to the points that were sampled: farthest point sampling of noisy points would
// favour outliers. The paper does not say which of the two comes first.

#include <cstdint>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::lab {

struct StairsOptions {
  std::uint64_t seed = 1;
  int points = 8192;       // farthest point sampling from a dense sampling; 0 = dense
  double noise_m = 0;      // standard deviation, on every coordinate, after the sampling
  bool random_yaw = true;  // false: axis-aligned
  int min_steps = 2, max_steps = 6;
  double min_length_m = 0.2, max_length_m = 0.4;
  double min_width_m = 0.3, max_width_m = 1.5;
  double min_height_m = 0.1, max_height_m = 0.3;
};

/// A staircase with its exact truth: `cloud.label` h on treads, v on risers; `cloud.instance`
/// from 1.
struct Stairs {
  PointSet cloud;
  std::vector<Vec3d> normals;  // by instance - 1, unit, outward
  int steps = 0;
  double length_m = 0, width_m = 0, height_m = 0, yaw_rad = 0;
};

/// Staircase `index` of the set, whatever was made before it.
Stairs make_stairs(int index, const StairsOptions& options);

/// Its risers and treads, in the cloud's coordinates.
std::vector<TruePolygon> true_polygons(const Stairs& stairs);

/// Its points and labels. Near an edge is what lies within 2 cm of a face of the other label.
planes::LabelledCloud labelled(const Stairs& stairs);

}  // namespace planescope::lab
