#pragma once

// The window on a display, and the same shell drawn into an EGL framebuffer where there is none.

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

// The shell in the current GL context, and its picture, which lasts from frame to frame: only the
// parts that a frame changes are drawn, as far as ImGui's draw lists show.

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

/// No window can be opened here.
struct NoDisplay : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  Settings settings;                 // size and place
  bool keep_settings = true;         // write them back when it closes
  std::vector<Script> scripts;       // played when the window is there
  std::filesystem::path state_file;  // state_facts() whenever they change; empty: nowhere
};

/// Shows the window until it is closed. Throws NoDisplay.
void run_window(State state, const WindowOptions& options, std::stop_token stop);

/// What a picture shows of a widget, or of a panel.
Image8 part_of(const Image8& whole, const WidgetRect& rect);

/// The window without a display.
class Offscreen : public Stage {
 public:
  /// Throws Error where there is no GL without a display either.
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
