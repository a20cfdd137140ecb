#pragma once

// The shell in the current GL context, and its picture, which lasts from frame to frame: only the
// parts that a frame changes are drawn, as far as ImGui's draw lists show.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "app/desktop/imgui.hpp"
#include "app/desktop/shell.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {

using render::Part;

class Damage {
 public:
  /// Where `frame` may look otherwise than the frame before: parts that do not overlap. All of the
  /// window at first, and where its size has changed. `version` tells apart what a texture holds
  /// now from what it held before.
  std::vector<Part> next(const ImDrawData& frame,
                         const std::function<std::uint64_t(ImTextureID)>& version);
  /// The frame before is lost.
  void forget() { tiles_ = {}; }

 private:
  render::Tiles tiles_;
};

/// Into `cut`, which is empty: what `frame` draws within the parts, and nothing outside them. Where
/// the parts hold what stood there, the window is then as if all of `frame` were drawn.
void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut);

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
  render::GlRenderbuffer color_ = render::GlRenderbuffer::make();
  render::GlFramebuffer framebuffer_ = render::GlFramebuffer::make();
  Canvas* canvas_ = nullptr;  // the shell's
  std::unique_ptr<Shell> shell_;
  Damage damage_;
  std::int64_t pixels_drawn_ = 0;
};

}  // namespace planescope::desktop
