#pragma once

// A GL context, and what draws draw lists into it.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/model/types.hpp"
#include "render/draw_list.hpp"
#include "render/tiles.hpp"

struct GLFWwindow;

namespace planescope::render {

/// A current GL 3.3 core context. EGL needs no display server (device platform, then surfaceless,
/// then default); GLFW needs one and also owns a window. Throws Error with what each attempt said.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6, EGL device"
  virtual std::string description() const = 0;
  virtual GLFWwindow* window() { return nullptr; }  // of a GLFW context
};
std::unique_ptr<GlContext> make_egl_context();
/// A resizable window, drawn in step with the screen. Size for a screen of ordinary density: it
/// grows with the monitor's scale.
std::unique_ptr<GlContext> make_glfw_context(int width,
                                             int height,
                                             const std::string& title,
                                             bool visible = true);

/// `quick` takes half the time on a CPU and leaves points and fills without antialiasing: for a
/// view that moves.
enum class Effort : std::uint8_t { fine, quick };

/// Draws a DrawList with GL 3.3 core into a framebuffer of its own. Needs a current context, and
/// the same one until it is destroyed.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// RGB picture, row 0 at the top, antialiased: points, drawn on the CPU (splats.hpp), with 4
  /// samples, all else by soft edges. Same input, same renderer: same pixels. Quicker where only
  /// colors of points differ from the picture before.
  /// `bare`: becomes the picture without title and legend.
  Image8 render(const DrawList& list,
                const Camera& camera,
                int width,
                int height,
                Theme theme,
                Image8* bare = nullptr);

  /// The same left on the GPU, drawn there alone with 4 samples, for a window: a GL texture of
  /// exactly width x height, opaque, row 0 at the bottom (draw it upside down). The renderer's own,
  /// valid until it draws again.
  std::uint32_t draw(const DrawList& list,
                     const Camera& camera,
                     int width,
                     int height,
                     Theme theme,
                     Effort effort = Effort::fine,
                     double screen_scale = 1);

  /// Where draw() has drawn last: nothing is drawn where the picture is the same as before.
  std::span<const Part> changes() const;

  /// Id under each pixel (0 none), for picking: no antialiasing, visible surface only.
  Image<std::uint32_t> render_ids(const DrawList& list,
                                  const Camera& camera,
                                  int width,
                                  int height);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bound framebuffer's lower left part as an RGB picture, row 0 at the top.
Image8 read_picture(int width, int height);

}  // namespace planescope::render
