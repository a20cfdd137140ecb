#pragma once

#include <span>

#include "core/lab/synthetic/scene.hpp"
#include "core/labels/model/label_files.hpp"

namespace planescope::lab {

/// Ground truth of a frame where it is known what every pixel sees: `surfaces` per pixel, indices
/// in scene.surfaces, -1 nothing.
FrameLabels true_labels(const Scene& scene,
                        const Pose& T_world_camera,
                        std::span<const int> surfaces,
                        const Frame& frame);

}  // namespace planescope::lab
