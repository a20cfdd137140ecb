#pragma once

#include <memory>
#include <string>

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

}  // namespace planescope::render
