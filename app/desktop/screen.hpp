#pragma once

// The shell in the current GL context, and its picture, which lasts from frame to frame.

#include <functional>
#include <memory>

#include "app/desktop/damage.hpp"
#include "app/desktop/shell.hpp"
#include "render/gl.hpp"

namespace planescope::desktop {

class Screen {
 public:
  /// Needs a current GL context, and the same one until it is destroyed.
  Screen(State state, std::function<void()> wake);
  /// Cancels what is under way.
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  Shell& shell() { return *shell_; }
  const Shell& shell() const { return *shell_; }
  /// One frame of that size. Only where it differs from the one before it is drawn.
  void draw(int width, int height, float scale, double seconds);
  /// The next frame is drawn as a whole.
  void forget() { damage_.forget(); }
  /// What the last frame drew.
  std::int64_t pixels_drawn() const { return pixels_drawn_; }
  /// Of the size of the last frame.
  GLuint framebuffer() const { return framebuffer_; }

 private:
  void resize(int width, int height);

  int width_ = 0, height_ = 0;
  render::GlRenderbuffer color_ = render::make_renderbuffer();
  render::GlFramebuffer framebuffer_ = render::make_framebuffer();
  Canvas* canvas_ = nullptr;  // the shell's
  std::unique_ptr<Shell> shell_;
  Damage damage_;
  std::int64_t pixels_drawn_ = 0;
};

}  // namespace planescope::desktop
