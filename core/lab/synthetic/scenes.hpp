#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

/// What make_scene knows: "stairs", "kerb", "ramp", "boxes", "corner".
const std::vector<std::string>& scene_names();

/// A scene as a walking robot's or a cane's camera sees it: 0.6 to 1 m above the ground, pitched
/// down by 25 to 40 degrees, most of it within 1.5 m of depth. The seed varies its dimensions by a
/// few per cent and the camera's pose. Throws Error naming the scenes there are.
Scene make_scene(const std::string& name, std::uint64_t seed);

}  // namespace planescope::lab
