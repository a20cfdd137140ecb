#pragma once

// The window on a display, and the same shell in an EGL framebuffer without one.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include "app/desktop/imgui.hpp"
#include "app/desktop/script.hpp"
#include "app/desktop/shell.hpp"
#include "app/desktop/state/session.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {

// Draws the shell in the current GL context into a persistent picture: only the parts that changed
// since the last frame, according to ImGui's draw lists, are drawn.

using render::Part;

class Damage {
 public:
  /// Returns the parts of `frame` that may differ from the previous frame, without overlap: the
  /// whole window at first and after its size has changed. `version` returns the version of a
  /// texture's contents.
  std::vector<Part> next(const ImDrawData& frame,
                         const std::function<std::uint64_t(ImTextureID)>& version);
  /// Call when the previous frame is lost.
  void forget() { tiles_ = {}; }

 private:
  render::Tiles tiles_;
};

/// Copies the part of `frame` within `parts` to `cut`, which must be empty. Drawing it over the
/// previous picture, with the parts cleared, gives the same result as drawing all of `frame`.
void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut);

class Screen {
 public:
  /// Requires a current GL context, which must be the same until destruction.
  Screen(State state, std::function<void()> wake);
  /// Cancels running work.
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  Shell& shell() { return *shell_; }
  const Shell& shell() const { return *shell_; }
  /// Draws one frame of this size, limited to the parts that changed.
  void draw(int width, int height, float scale, double seconds);
  /// Redraws the next frame completely.
  void forget() { damage_.forget(); }
  /// Number of pixels drawn in the last frame.
  std::int64_t pixels_drawn() const { return pixels_drawn_; }
  /// Has the size of the last frame.
  GLuint framebuffer() const { return framebuffer_; }

 private:
  void resize(int width, int height);

  int width_ = 0, height_ = 0;
  render::GlRenderbuffer color_ = render::GlRenderbuffer::make();
  render::GlFramebuffer framebuffer_ = render::GlFramebuffer::make();
  Canvas* canvas_ = nullptr;  // owned by the shell
  std::unique_ptr<Shell> shell_;
  Damage damage_;
  std::int64_t pixels_drawn_ = 0;
};

/// Thrown when no window can be opened.
struct NoDisplay : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  Settings settings;                 // size and position
  bool keep_settings = true;         // write them back on close
  std::vector<Script> scripts;       // played when the window is open
  std::filesystem::path state_file;  // state_facts() after every change; empty: none
};

/// Shows the window until it is closed. Throws NoDisplay.
void run_window(State state, const WindowOptions& options, std::stop_token stop);

/// Crops a picture to a widget or panel.
Image8 part_of(const Image8& whole, const WidgetRect& rect);

/// The window without a display.
class Offscreen : public Stage {
 public:
  /// Throws Error if offscreen GL is not available either.
  Offscreen(State state, int width, int height, float scale);
  ~Offscreen() override;

  Shell& shell() { return screen_->shell(); }
  Screen& screen() { return *screen_; }
  void draw_frame() override;
  /// Waits until the last frame is drawn.
  void finish();
  Image8 picture() override;

 private:
  int width_, height_;
  float scale_;
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<Screen> screen_;
};

}  // namespace planescope::desktop
