#pragma once

// How the state is looked at: where the camera stands, what both views draw, what is under the
// mouse. Pure functions.

#include <string>

#include "app/desktop/state/state.hpp"
#include "render/label_scene.hpp"

namespace planescope::desktop {

enum class CameraPreset : std::uint8_t { home, top, side, front };
/// `home`: the frame's own camera, at whose distance the others stand.
render::Camera preset_camera(const render::Camera& home, CameraPreset preset);

/// The one in force: the user's, or the frame's own.
render::Camera camera_of(const State& state);

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg);
/// `right`, `up`: in heights of the view at the target's distance.
render::Camera panned(const render::Camera& camera, double right, double up);
/// Nearer to the target for factors above 1.
render::Camera zoomed(const render::Camera& camera, double factor);

/// Cameras are made for views of 4:3; a narrower one shows as much from side to side.
render::Camera fitted(render::Camera camera, double aspect);
bool same_camera(const render::Camera& a, const render::Camera& b);

/// What the 3D view and the image draw. What is only selected because the cursor is on it is shown
/// as the cursor's, not as a choice of the user's.
render::StepLook look_of(const State& state);

/// What both views of the label mode draw. Its spans are the state's.
render::LabelLook label_look_of(const State& state);
/// Of the plane that the wand shows, or else of the active one; nullopt where it is not looked at.
std::optional<render::Residual> residual_of(const State& state);

/// "voxel 812 (h), in P3, true plane 2", and its node in a second line: what is known at the
/// cursor.
std::string describe_voxel(const State& state, std::int32_t voxel);
/// "node 41, depth 5, 12 points, case IV".
std::string describe_node(const State& state, std::int32_t node);

}  // namespace planescope::desktop
