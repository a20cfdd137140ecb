#pragma once

// Renders a scene as seen and measured by a camera, with exact truth.

#include <cstdint>
#include <span>
#include <vector>

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/scene.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/frame.hpp"

namespace planescope::lab {

/// The left imager's exact view of a scene, before measurement.
struct SceneView {
  TrueView depth;
  std::vector<int> surfaces;  // per pixel, index in Scene::surfaces; -1 nothing
};
/// The right imager's visibility is computed only if the model has noise.
SceneView view_scene(const Scene& scene, const CameraPose& camera, const D435Model& model);

/// Renders a scene through the camera: depth, and aligned color. The seed affects only the noise;
/// the same arguments give the same frame on every machine. The frame has no gravity.
///
/// `truth`, if given, becomes the frame's exact ground truth: the plane of every pixel whose ray
/// hits one, measured or not (0: nothing or a curved surface), h/v by the true normal, the visible
/// planes with normals towards the camera, and the true direction of gravity.
Frame render_scene(const Scene& scene,
                   const CameraPose& camera,
                   const D435Model& model,
                   std::uint64_t seed,
                   FrameLabels* truth = nullptr);

/// SHA-256 of a depth image as little-endian counts, equal to its Recording::frame_hash.
std::string depth_sha256(const Image16& depth);

/// Ground truth of a frame from the surface at every pixel: `surfaces` contains indices in
/// scene.surfaces, -1 nothing.
FrameLabels true_labels(const Scene& scene,
                        const Pose& T_world_camera,
                        std::span<const int> surfaces,
                        const Frame& frame);

}  // namespace planescope::lab
