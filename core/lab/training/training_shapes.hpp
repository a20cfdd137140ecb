#pragma once

#include <cstdint>

#include "core/lab/training/training_set.hpp"

namespace planescope::lab {

/// The paper's objects (Sec. III), sizes drawn uniformly from its ranges; clean, axis-aligned,
/// decided by the seed alone.

/// 2 to 6 steps of length 0.2-0.4 m, width 0.2-1.5 m and height 0.08-0.3 m.
planes::LabelledCloud make_stairs_shape(std::uint64_t seed, int points);

/// Length and width 0.1-2 m, height 0.08-0.3 m: a top and four sides. The paper does not say what
/// boxes stand on: `on_floor` lays floor around it, 10-50 cm wide.
planes::LabelledCloud make_box_shape(std::uint64_t seed, int points, bool on_floor);

/// Length and width 0.1-2 m, two edges level, the normal's z component uniform in [-1, 1].
planes::LabelledCloud make_plane_shape(std::uint64_t seed, int points);

}  // namespace planescope::lab
