#pragma once

// The window without a display: the same shell, drawn into an EGL framebuffer.

#include <memory>

#include "app/desktop/script.hpp"
#include "render/context.hpp"

namespace planescope::desktop {

class Offscreen : public Stage {
 public:
  /// Throws Error where there is no GL without a display either.
  Offscreen(State state, int width, int height, float scale);
  ~Offscreen() override;

  Shell& shell() { return *shell_; }
  void draw_frame() override;
  void screenshot(const std::filesystem::path& path) override;
  /// Waits until the last frame is drawn.
  void finish();
  /// What the last frame shows. RGB, row 0 at the top.
  Image8 picture();

 private:
  struct Target;
  int width_, height_;
  float scale_;
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<Target> target_;
  std::unique_ptr<Shell> shell_;
};

}  // namespace planescope::desktop
