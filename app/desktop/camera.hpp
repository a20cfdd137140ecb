#pragma once

// The 3D view's camera: presets and what the mouse does to it. Pure functions.

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

enum class CameraPreset : std::uint8_t { home, top, side, front };
/// `home`: the frame's own camera, at whose distance the others stand.
render::Camera preset_camera(const render::Camera& home, CameraPreset preset);

/// The one in force: the user's, or the frame's own.
render::Camera camera_of(const State& state);

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg);
/// In heights of the view, at the target's distance.
render::Camera panned(const render::Camera& camera, double right, double up);
/// Nearer to the target for factors above 1.
render::Camera zoomed(const render::Camera& camera, double factor);

/// Cameras are made for views of 4:3; a narrower one shows as much from side to side.
render::Camera fitted(render::Camera camera, double aspect);
bool same_camera(const render::Camera& a, const render::Camera& b);

}  // namespace planescope::desktop
