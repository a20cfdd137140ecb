// GL contexts: EGL off-screen, GLFW with a window.

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include "core/model/error.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::render {

// ---- EGL ----

// Without a display server: the device platform (a GPU's render node or Mesa's software device),
// then Mesa's surfaceless platform, then the default display.

namespace {

std::string egl_error() {
  constexpr std::array kNames = {"SUCCESS",       "NOT_INITIALIZED",     "BAD_ACCESS",
                                 "BAD_ALLOC",     "BAD_ATTRIBUTE",       "BAD_CONFIG",
                                 "BAD_CONTEXT",   "BAD_CURRENT_SURFACE", "BAD_DISPLAY",
                                 "BAD_MATCH",     "BAD_NATIVE_PIXMAP",   "BAD_NATIVE_WINDOW",
                                 "BAD_PARAMETER", "BAD_SURFACE",         "CONTEXT_LOST"};
  const auto i = static_cast<std::size_t>(eglGetError() - EGL_SUCCESS);
  return i < kNames.size() ? std::string("EGL_") + kNames[i] : "an unknown EGL error";
}

std::string failed(const char* call) { return fmt::format("{}: {}", call, egl_error()); }

class EglContext : public GlContext {
 public:
  /// Empty `error` on success.
  static std::unique_ptr<EglContext> open(EGLDisplay display,
                                          const std::string& way,
                                          std::string& error);
  ~EglContext() override {
    if (eglGetCurrentContext() == context_) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    // The display stays initialized: it is one object per process, whoever asks for it, so that
    // others may still be drawing with it, and Mesa leaks a little when it is unloaded.
  }
  void make_current() override {
    if (!eglMakeCurrent(display_, surface_, surface_, context_)) {
      throw Error(fmt::format("cannot make the {} context current: {}", way_, egl_error()));
    }
  }
  std::string description() const override { return description_; }

 private:
  EglContext(EGLDisplay display, std::string way) : display_(display), way_(std::move(way)) {}
  std::string create();

  EGLDisplay display_;
  std::string way_;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
  std::string description_;
};

std::unique_ptr<EglContext> EglContext::open(EGLDisplay display,
                                             const std::string& way,
                                             std::string& error) {
  if (display == EGL_NO_DISPLAY) {
    error = "no display";
    return nullptr;
  }
  if (!eglInitialize(display, nullptr, nullptr)) {
    error = failed("eglInitialize");
    return nullptr;
  }
  std::unique_ptr<EglContext> context(new EglContext(display, way));
  error = context->create();
  return error.empty() ? std::move(context) : nullptr;
}

// Returns what failed, empty on success.
std::string EglContext::create() {
  if (!eglBindAPI(EGL_OPENGL_API)) return failed("eglBindAPI(EGL_OPENGL_API)");
  const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                      EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint config_count = 0;
  if (!eglChooseConfig(display_, config_attributes, &config, 1, &config_count)) {
    return failed("eglChooseConfig");
  }
  if (config_count == 0) return "eglChooseConfig: no configuration with OpenGL";
  // clang-format off
  const EGLint context_attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3,
      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  // clang-format on
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, context_attributes);
  if (context_ == EGL_NO_CONTEXT) return failed("eglCreateContext (OpenGL 3.3 core)");
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    // No EGL_KHR_surfaceless_context: a small surface that nobody draws into.
    const EGLint surface_attributes[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display_, config, surface_attributes);
    if (surface_ == EGL_NO_SURFACE) return failed("eglCreatePbufferSurface");
    if (!eglMakeCurrent(display_, surface_, surface_, context_)) return failed("eglMakeCurrent");
  }
  description_ = fmt::format("{}, {}", gl_description(), way_);
  return {};
}

bool has_client_extension(const char* name) {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return extensions != nullptr && std::strstr(extensions, name) != nullptr;
}

}  // namespace

std::unique_ptr<GlContext> make_egl_context() {
  std::vector<std::string> attempts;  // what each answered
  std::string error;
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  const auto query_devices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));

  if (get_platform_display == nullptr || query_devices == nullptr ||
      !has_client_extension("EGL_EXT_platform_device")) {
    attempts.emplace_back("device platform: not supported");
  } else {
    EGLDeviceEXT devices[16] = {};
    EGLint device_count = 0;
    if (!query_devices(16, devices, &device_count)) {
      attempts.push_back("device platform: " + failed("eglQueryDevicesEXT"));
    } else if (device_count == 0) {
      attempts.emplace_back("device platform: no device");
    }
    for (EGLint i = 0; i < device_count; ++i) {
      const EGLDisplay display = get_platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
      if (auto context = EglContext::open(display, "EGL device", error)) return context;
      attempts.push_back(fmt::format("device {}: {}", i, error));
    }
  }

  if (get_platform_display == nullptr || !has_client_extension("EGL_MESA_platform_surfaceless")) {
    attempts.emplace_back("surfaceless platform: not supported");
  } else {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (auto context = EglContext::open(display, "EGL surfaceless", error)) return context;
    attempts.push_back("surfaceless platform: " + error);
  }

  if (auto context =
          EglContext::open(eglGetDisplay(EGL_DEFAULT_DISPLAY), "EGL default display", error)) {
    return context;
  }
  attempts.push_back("default display: " + error);

  throw Error(
      fmt::format("no OpenGL 3.3 core context through EGL: {} (Debian: libegl1, libopengl0 "
                  "and libgl1-mesa-dri give a software one)",
                  fmt::join(attempts, "; ")));
}

// ---- GLFW ----

// A window of its own and its GL context. Needs a display server.

namespace {

std::string glfw_answer() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

// GLFW is initialized once per process and ended with the last window.
std::mutex users_mutex;
int users = 0;

void acquire_glfw() {
  const std::lock_guard lock(users_mutex);
  if (users == 0 && !glfwInit()) throw Error("cannot open a window: " + glfw_answer());
  ++users;
}

void release_glfw() {
  const std::lock_guard lock(users_mutex);
  if (--users == 0) glfwTerminate();
}

class GlfwContext : public GlContext {
 public:
  GlfwContext(int width, int height, const std::string& title, bool visible) {
    acquire_glfw();
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_TRUE);
    // What desktops know its windows by: planescope.desktop has the same name.
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "planescope");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "planescope");
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);  // the same apparent size at any density
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
      const std::string answer = glfw_answer();
      release_glfw();
      throw Error("cannot open a window with OpenGL 3.3 core: " + answer);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);  // never faster than the screen
    description_ = gl_description() + ", GLFW window";
  }
  ~GlfwContext() override {
    glfwDestroyWindow(window_);
    release_glfw();
  }
  void make_current() override { glfwMakeContextCurrent(window_); }
  std::string description() const override { return description_; }
  GLFWwindow* window() override { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
  std::string description_;
};

}  // namespace

std::unique_ptr<GlContext> make_glfw_context(int width,
                                             int height,
                                             const std::string& title,
                                             bool visible) {
  return std::make_unique<GlfwContext>(width, height, title, visible);
}

}  // namespace planescope::render
