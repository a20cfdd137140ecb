#pragma once

// How the state is displayed: the camera, the contents of both views, and the item under the mouse.
// Pure functions.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "app/desktop/state/state.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {

/// The current camera: the user's, or one that shows the whole frame.
render::Camera camera_of(const State& state);
/// The same for a view with this aspect ratio.
render::Camera scene_camera(const State& state, double aspect);

/// Points of the selected point, plane or node, otherwise of the marked region.
std::vector<Vec3f> selected_points(const State& state);
/// A camera in the same direction that shows the points and some of their surroundings.
render::Camera camera_on(const State& state, std::span<const Vec3f> points);

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg);
/// `right` and `up` are in view heights at the target's distance.
render::Camera panned(const render::Camera& camera, double right, double up);
/// Factors above 1 move closer to the target.
render::Camera zoomed(const render::Camera& camera, double factor);

bool same_camera(const render::Camera& a, const render::Camera& b);

/// The look of the 3D view and the image view. An item selected only by the cursor is drawn as the
/// cursor's, not as the user's selection.
render::StepLook look_of(const State& state);
/// The same step and selection in the run shown beside it (State::other_view()).
render::StepLook other_look_of(const State& state);
/// Colors of a run's planes: those of the strip once it has processed the frame, the run's own
/// before that. A pinned run keeps the colors it had when it was pinned.
const FrameColors& shown_colors(const State& state, const RunView& of);
/// The same as color ids of the trace's planes.
std::vector<int> colors_of_planes(const State& state, const RunView& of);
/// Color ids of true planes, by id - 1.
std::vector<int> colors_of_truth(const State& state, const RunView& of);

/// The look of both views in label mode. Its spans point into the state.
render::LabelLook label_look_of(const State& state);
/// Residuals of the wand's plane if there is one, otherwise of the active plane; nullopt if they
/// are not shown.
std::optional<render::Residual> residual_of(const State& state);

/// "voxel 812 (h), in P3, true plane 2", with its node on a second line, at the cursor's step.
std::string describe_voxel(const State& state, std::int32_t voxel);
/// "node 41, depth 5, 12 points, case IV".
std::string describe_node(const State& state, std::int32_t node);

// Renders the 3D view, the image view and the thumbnails: with GL in a window and offscreen, not at
// all in tests of panels.

using TextureId = std::uint64_t;  // 0: nothing to show

struct LabelFrame;

/// The side of the main run, or of the second run shown beside it.
enum class Side : std::uint8_t { here, beside };

class Canvas {
 public:
  virtual ~Canvas() = default;
  /// Renders the scene to a texture of this size, only if something changed. Row 0 is at the
  /// bottom.
  virtual TextureId scene(const std::shared_ptr<const debug::Run>& run,
                          const render::StepLook& look,
                          const render::Camera& camera,
                          int width,
                          int height,
                          Side side = Side::here) = 0;
  /// Returns the item at pixel (x, y), from the top left of the last drawn scene, or the nearest
  /// one within `reach_px`.
  virtual render::Picked pick(int x, int y, int reach_px) = 0;
  /// image_step() as a texture with one texel per pixel. Row 0 is at the top.
  virtual TextureId image(const std::shared_ptr<const debug::Run>& run,
                          const render::StepLook& look,
                          render::Backdrop backdrop,
                          double opacity,
                          Side side = Side::here) = 0;
  /// The same for labels: the frame's points, and an image with one texel per depth pixel.
  virtual TextureId label_scene(const std::shared_ptr<const LabelFrame>& frame,
                                const render::LabelLook& look,
                                const render::Camera& camera,
                                int width,
                                int height) = 0;
  virtual TextureId label_image(const std::shared_ptr<const LabelFrame>& frame,
                                const render::LabelLook& look,
                                render::Backdrop backdrop,
                                double opacity) = 0;
  /// Any picture by key; uploaded again if `version` changes. Row 0 is at the top.
  virtual TextureId picture(const std::string& key, const Image8& image, std::uint64_t version) = 0;
  /// Version of a texture's contents; changes with them.
  virtual std::uint64_t version(TextureId texture) const = 0;

  double screen_scale = 1;  // of text and lines in scenes
};

/// Requires a current GL context, which must be the same until destruction.
std::unique_ptr<Canvas> make_gl_canvas();

}  // namespace planescope::desktop
