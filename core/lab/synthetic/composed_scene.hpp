#pragma once

#include <cstdint>

#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

/// A scene put together at random: a floor, and on it stairs, boxes, a kerb, a ramp or slab, walls,
/// in sizes from the paper's ranges (Sec. III). The camera stands 0.4 to 1.2 m high, 0.3 to 1.5 m
/// before the first of them, pitched down by 15 to 60 degrees and rolled by up to 10.
Scene compose_scene(std::uint64_t seed);

}  // namespace planescope::lab
