#pragma once

// How the state is looked at: where the camera stands, what both views draw, what is under the
// mouse. Pure functions.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "app/desktop/state/state.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {

/// The one in force: the user's, or one from which all of the frame fills the view.
render::Camera camera_of(const State& state);
/// The same as it is drawn in a view of that shape.
render::Camera scene_camera(const State& state, double aspect);

/// What is selected, in space: a point, a plane, a node, or else what was marked.
std::vector<Vec3f> selected_points(const State& state);
/// From which the points and some of their surroundings fill the view, looking the same way.
render::Camera camera_on(const State& state, std::span<const Vec3f> points);

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg);
/// `right`, `up`: in heights of the view at the target's distance.
render::Camera panned(const render::Camera& camera, double right, double up);
/// Nearer to the target for factors above 1.
render::Camera zoomed(const render::Camera& camera, double factor);

bool same_camera(const render::Camera& a, const render::Camera& b);

/// What the 3D view and the image draw. What is only selected because the cursor is on it is shown
/// as the cursor's, not as a choice of the user's.
render::StepLook look_of(const State& state);
/// The same place and selection in the run that is shown beside it (State::other_view()).
render::StepLook other_look_of(const State& state);
/// Colors in which a run's planes are shown: the strip's once it has reached the frame, the run's
/// own until then. A pinned run keeps those that it was pinned with.
const FrameColors& shown_colors(const State& state, const RunView& of);
/// The same as color ids of the planes of the run's trace.
std::vector<int> colors_of_planes(const State& state, const RunView& of);
/// Color ids of true planes, by id - 1.
std::vector<int> colors_of_truth(const State& state, const RunView& of);

/// What both views of the label mode draw. Its spans are the state's.
render::LabelLook label_look_of(const State& state);
/// Of the plane that the wand shows, or else of the active one; nullopt where it is not looked at.
std::optional<render::Residual> residual_of(const State& state);

/// "voxel 812 (h), in P3, true plane 2", and its node in a second line: what is known at the
/// cursor.
std::string describe_voxel(const State& state, std::int32_t voxel);
/// "node 41, depth 5, 12 points, case IV".
std::string describe_node(const State& state, std::int32_t node);

// Where the 3D view, the image view and the thumbnails get their pixels: GL in a window and
// off-screen, nothing in tests of the panels.

using TextureId = std::uint64_t;  // 0: nothing to show

struct LabelFrame;

/// Of two runs that are shown beside each other: the one that is looked at, and the other one.
enum class Side : std::uint8_t { here, beside };

class Canvas {
 public:
  virtual ~Canvas() = default;
  /// The scene as a texture of that size, drawn anew only where something changed. Row 0 at the
  /// bottom.
  virtual TextureId scene(const std::shared_ptr<const debug::Run>& run,
                          const render::StepLook& look,
                          const render::Camera& camera,
                          int width,
                          int height,
                          Side side = Side::here) = 0;
  /// What is seen at pixel (x, y) from the top left of the scene drawn last, or else within
  /// `reach_px` of it.
  virtual render::Picked pick(int x, int y, int reach_px) = 0;
  /// image_step() as a texture of one texel per pixel. Row 0 at the top.
  virtual TextureId image(const std::shared_ptr<const debug::Run>& run,
                          const render::StepLook& look,
                          render::Backdrop backdrop,
                          double opacity,
                          Side side = Side::here) = 0;
  /// The same for labels: the frame's points, and one texel per depth pixel.
  virtual TextureId label_scene(const std::shared_ptr<const LabelFrame>& frame,
                                const render::LabelLook& look,
                                const render::Camera& camera,
                                int width,
                                int height) = 0;
  virtual TextureId label_image(const std::shared_ptr<const LabelFrame>& frame,
                                const render::LabelLook& look,
                                render::Backdrop backdrop,
                                double opacity) = 0;
  /// Any picture by a key; uploaded again when `version` differs. Row 0 at the top.
  virtual TextureId picture(const std::string& key, const Image8& image, std::uint64_t version) = 0;
  /// Of what a texture holds: another one whenever that has changed.
  virtual std::uint64_t version(TextureId texture) const = 0;

  double screen_scale = 1;  // of text and lines in scenes
};

/// Needs a current GL context, and the same one until it is destroyed.
std::unique_ptr<Canvas> make_gl_canvas();

}  // namespace planescope::desktop
