#pragma once

// Whole scenes: hand-made ones by name, and any number of random compositions.

#include <cstdint>
#include <string>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

/// Names for make_scene(): "stairs", "kerb", "ramp", "boxes", "corner".
const std::vector<std::string>& scene_names();

/// A scene as seen by the camera of a walking robot or a cane: 0.6 to 1 m above the ground, pitched
/// down by 25 to 40 degrees, most of it within 1.5 m of depth. The seed varies its dimensions by a
/// few percent and the camera's pose. Throws Error that lists the scenes.
Scene make_scene(const std::string& name, std::uint64_t seed);

/// Builds a scene of an evaluation set; for all sets except "stairs".
using BuildScene = void (*)(Scene&, Random&);
BuildScene build_of_set(const std::string& set);

/// A random scene: a floor with stairs, boxes, a kerb, a ramp or slab, and walls, in sizes from the
/// paper's ranges (Sec. III). The camera is 0.4 to 1.2 m high, 0.3 to 1.5 m before the first
/// object, pitched down by 15 to 60 degrees and rolled by up to 10.
Scene compose_scene(std::uint64_t seed);

}  // namespace planescope::lab
