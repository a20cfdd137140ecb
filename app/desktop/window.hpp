#pragma once

// The window on a display, and the same shell drawn into an EGL framebuffer where there is none.

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>

#include "app/desktop/screen.hpp"
#include "app/desktop/script.hpp"
#include "app/desktop/state/session.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {

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
  void screenshot(const std::filesystem::path& path,
                  const std::optional<WidgetRect>& part = {}) override;
  /// Waits until the last frame is drawn.
  void finish();
  /// What the last frame shows. RGB, row 0 at the top.
  Image8 picture();

 private:
  int width_, height_;
  float scale_;
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<Screen> screen_;
};

}  // namespace planescope::desktop
