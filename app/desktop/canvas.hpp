#pragma once

// Where the 3D view, the image view and the thumbnails get their pixels: GL in a window and
// off-screen, nothing in tests of the panels.

#include <cstdint>
#include <memory>
#include <string>

#include "render/step_scene.hpp"

namespace planescope::desktop {

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
