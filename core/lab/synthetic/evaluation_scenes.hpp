#pragma once

// What the evaluation sets show, put together at random.

#include "core/lab/synthetic/scene.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

/// Whole objects, of which points are sampled on every face there is.
void build_side_walls(Scene& scene, Random& random);
void build_open_risers(Scene& scene, Random& random);
void build_spiral(Scene& scene, Random& random);
void build_equal_boxes(Scene& scene, Random& random);
void build_ramps(Scene& scene, Random& random);
void build_kerbs(Scene& scene, Random& random);

/// Views: something on the ground, 0.5 to 1.1 m before a camera that stands 0.6 to 1 m high and is
/// pitched down by 25 to 45 degrees. How much of it shows is left to chance.
void build_stairs_view(Scene& scene, Random& random);
void build_boxes_view(Scene& scene, Random& random);
void build_slopes_view(Scene& scene, Random& random);

/// Stairs seen from their top: a camera 0.5 to 0.9 m above the landing and 0.2 to 0.6 m behind its
/// edge, pitched down by 30 to 55 degrees; between walls or open to the sides.
void build_descent_view(Scene& scene, Random& random);

}  // namespace planescope::lab
