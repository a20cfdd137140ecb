#pragma once

// Scenes as a camera sees and measures them, with their exact truth.

#include <cstdint>
#include <span>
#include <vector>

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/scene.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/frame.hpp"

namespace planescope::lab {

/// A scene as the left imager sees it, before the camera measures: exact.
struct SceneView {
  TrueView depth;
  std::vector<int> surfaces;  // per pixel, index in Scene::surfaces; -1 nothing
};
/// What the right imager sees too is known only where the model has noise.
SceneView view_scene(const Scene& scene, const CameraPose& camera, const D435Model& model);

/// A scene through the camera: depth, and colour aligned to it. The seed drives the noise alone;
/// the same arguments give the same frame on every machine. The frame knows no gravity.
///
/// `truth`, where given, becomes the frame's exact ground truth: the plane of every pixel whose ray
/// hits one, measured or not (0: nothing or something curved), h/v by the true normal, the planes
/// in view with normals towards the camera, and the true direction of gravity.
Frame render_scene(const Scene& scene,
                   const CameraPose& camera,
                   const D435Model& model,
                   std::uint64_t seed,
                   FrameLabels* truth = nullptr);

/// SHA-256 of a depth image as little-endian counts: what Recording::frame_hash gives for it.
std::string depth_sha256(const Image16& depth);

/// Ground truth of a frame where it is known what every pixel sees: `surfaces` per pixel, indices
/// in scene.surfaces, -1 nothing.
FrameLabels true_labels(const Scene& scene,
                        const Pose& T_world_camera,
                        std::span<const int> surfaces,
                        const Frame& frame);

}  // namespace planescope::lab
