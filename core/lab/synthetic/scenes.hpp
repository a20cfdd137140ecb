#pragma once

// Whole scenes: some by name, made by hand, and any number that are composed at random.

#include <cstdint>
#include <string>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

/// What make_scene knows: "stairs", "kerb", "ramp", "boxes", "corner".
const std::vector<std::string>& scene_names();

/// A scene as a walking robot's or a cane's camera sees it: 0.6 to 1 m above the ground, pitched
/// down by 25 to 40 degrees, most of it within 1.5 m of depth. The seed varies its dimensions by a
/// few per cent and the camera's pose. Throws Error naming the scenes there are.
Scene make_scene(const std::string& name, std::uint64_t seed);

/// How a scene of an evaluation set is put together; of all sets but "stairs".
using BuildScene = void (*)(Scene&, Random&);
BuildScene build_of_set(const std::string& set);

/// A scene put together at random: a floor, and on it stairs, boxes, a kerb, a ramp or slab, walls,
/// in sizes from the paper's ranges (Sec. III). The camera stands 0.4 to 1.2 m high, 0.3 to 1.5 m
/// before the first of them, pitched down by 15 to 60 degrees and rolled by up to 10.
Scene compose_scene(std::uint64_t seed);

}  // namespace planescope::lab
