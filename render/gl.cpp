// OpenGL programs, targets, textures, and contexts from EGL or a GLFW window.

#include "render/gl.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "core/model/error.hpp"
#include "render/renderer.hpp"

namespace planescope::render {

// ---- Programs ----

namespace {

/// Returns the driver's log for a shader or program, in one line.
template <typename Get, typename Log>
std::string info_log(GLuint id, Get get, Log log) {
  GLint length = 0;
  get(id, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<std::size_t>(length), ' ');
  log(id, length, nullptr, text.data());
  text = text.c_str();  // trim at the terminating zero
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

GLuint compile(GLenum kind, const char* name, std::string_view source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.data();
  const GLint length = static_cast<GLint>(source.size());
  glShaderSource(shader, 1, &text, &length);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  const std::string log = info_log(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  throw Error(fmt::format("the {} shader of '{}' does not compile: {}",
                          kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log));
}

}  // namespace

GlProgram make_program(const char* name, std::string_view vertex, std::string_view fragment) {
  GlProgram program(glCreateProgram());
  for (const auto& [kind, source] :
       {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = compile(kind, name, source);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // deleted with the program
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  throw Error(fmt::format("the shaders of '{}' do not link: {}", name,
                          info_log(program, glGetProgramiv, glGetProgramInfoLog)));
}

void check_gl(const char* where) {
  constexpr std::array kNames = {"GL_INVALID_ENUM",
                                 "GL_INVALID_VALUE",
                                 "GL_INVALID_OPERATION",
                                 "GL_STACK_OVERFLOW",
                                 "GL_STACK_UNDERFLOW",
                                 "GL_OUT_OF_MEMORY",
                                 "GL_INVALID_FRAMEBUFFER_OPERATION"};
  const GLenum code = glGetError();
  if (code == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  const std::size_t i = code - GL_INVALID_ENUM;
  throw Error(fmt::format("OpenGL reports {} in {}",
                          i < kNames.size() ? kNames[i] : "an unknown error", where));
}

std::string gl_description() {
  const auto text = [](GLenum what) {
    const GLubyte* value = glGetString(what);
    return value != nullptr ? std::string(reinterpret_cast<const char*>(value)) : std::string("?");
  };
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major < 3 || (major == 3 && minor < 3)) {
    throw Error(fmt::format("OpenGL version '{}' ({}); expected 3.3 core", text(GL_VERSION),
                            text(GL_RENDERER)));
  }
  // "4.5 (Core Profile) Mesa 22.3.6" -> "Mesa 22.3.6"
  std::string version = text(GL_VERSION);
  if (const std::size_t at = version.find("(Core Profile) "); at != std::string::npos) {
    version = version.substr(at + std::strlen("(Core Profile) "));
  }
  return text(GL_RENDERER) + ", " + version;
}

// ---- Framebuffers ----

namespace {

GlRenderbuffer storage(int samples, GLenum format, int width, int height) {
  GlRenderbuffer buffer = GlRenderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  return buffer;
}

GlTexture texture(GLint format, GLenum channels, int width, int height) {
  GlTexture result = GlTexture::make();
  glBindTexture(GL_TEXTURE_2D, result);
  glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, channels, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return result;
}

void attach(GLenum point, const GlRenderbuffer& buffer) {
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, buffer);
}
void attach(GLenum point, const GlTexture& texture) {
  glFramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, texture, 0);
}

template <typename Color, typename Depth>
GlFramebuffer framebuffer_of(const Color& color, const Depth& depth) {
  GlFramebuffer result = GlFramebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, result);
  attach(GL_COLOR_ATTACHMENT0, color);
  attach(GL_DEPTH_ATTACHMENT, depth);
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return result;
  throw Error(
      fmt::format("OpenGL does not support this picture size (framebuffer status {:#x})", status));
}

void check_size(int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width >= 1 && height >= 1 && width <= largest && height <= largest) return;
  throw Error(fmt::format("picture size {} x {} is out of range (1 to {} px in each direction)",
                          width, height, largest));
}

}  // namespace

void SceneTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;  // until all buffers exist
  color = storage(samples, GL_RGBA8, new_width, new_height);
  depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  box_depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  scene = framebuffer_of(color, depth);
  boxes = framebuffer_of(color, box_depth);
  flat_depth = texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, new_width, new_height);
  flat_color = texture(GL_RGBA8, GL_RGBA, new_width, new_height);
  // The alpha channel has no meaningful values after blending.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
  glBindTexture(GL_TEXTURE_2D, 0);
  resolved = framebuffer_of(flat_color, flat_depth);
  width = new_width;
  height = new_height;
}

void IdTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;
  ids = storage(0, GL_R32UI, new_width, new_height);
  depth = storage(0, GL_DEPTH_COMPONENT24, new_width, new_height);
  framebuffer = framebuffer_of(ids, depth);
  width = new_width;
  height = new_height;
}

// ---- Images as textures ----

void ImageTexture::upload(const Image8& image) {
  assert(!image.empty() && (image.channels == 3 || image.channels == 4));
  GLint before = 0;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &before);
  const bool same = width_ == image.width && height_ == image.height && channels_ == image.channels;
  if (texture_ == 0) texture_ = GlTexture::make();
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const GLenum channels = image.channels == 3 ? GL_RGB : GL_RGBA;
  if (same) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, channels, GL_UNSIGNED_BYTE,
                    image.data.data());
  } else {
    glTexImage2D(GL_TEXTURE_2D, 0, image.channels == 3 ? GL_RGB8 : GL_RGBA8, image.width,
                 image.height, 0, channels, GL_UNSIGNED_BYTE, image.data.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(before));
  width_ = image.width;
  height_ = image.height;
  channels_ = image.channels;
  check_gl("uploading an image");
}

// ---- Contexts: EGL off-screen, GLFW with a window ----

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

class EglContext : public GlContext {
 public:
  /// Made current. Throws Error naming the failed call.
  EglContext(EGLDisplay display, const char* way) : EglContext(display) {
    way_ = way;
    const auto expect = [](bool succeeded, const char* call) {
      if (!succeeded) throw Error(fmt::format("{}: {}", call, egl_error()));
    };
    if (display == EGL_NO_DISPLAY) throw Error("no display");
    expect(eglInitialize(display, nullptr, nullptr), "eglInitialize");
    expect(eglBindAPI(EGL_OPENGL_API), "eglBindAPI(EGL_OPENGL_API)");
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                        EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    expect(eglChooseConfig(display, config_attributes, &config, 1, &count), "eglChooseConfig");
    if (count == 0) throw Error("eglChooseConfig: no configuration with OpenGL");
    // clang-format off
    const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    // clang-format on
    context_ = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    expect(context_ != EGL_NO_CONTEXT, "eglCreateContext (OpenGL 3.3 core)");
    if (!bind()) {
      // Without EGL_KHR_surfaceless_context: create a small surface that is never drawn to.
      const EGLint surface_attributes[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
      surface_ = eglCreatePbufferSurface(display, config, surface_attributes);
      expect(surface_ != EGL_NO_SURFACE, "eglCreatePbufferSurface");
      expect(bind(), "eglMakeCurrent");
    }
    description_ = fmt::format("{}, {}", gl_description(), way);
  }
  ~EglContext() override {  // also after incomplete construction
    if (context_ == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context_)
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
    eglDestroyContext(display_, context_);
    // Keep the display initialized: it is shared by the whole process and may still be in use, and
    // unloading Mesa leaks a little memory.
  }
  void make_current() override {
    if (!bind())
      throw Error(fmt::format("cannot make the {} context current: {}", way_, egl_error()));
  }
  std::string description() const override { return description_; }

 private:
  explicit EglContext(EGLDisplay display) : display_(display) {}
  bool bind() const { return eglMakeCurrent(display_, surface_, surface_, context_) == EGL_TRUE; }

  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
  std::string way_, description_;
};

bool has_client_extension(const char* name) {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return extensions != nullptr && std::strstr(extensions, name) != nullptr;
}

}  // namespace

/// Without a display server: tries the device platform (a GPU's render node or Mesa's software
/// device), then Mesa's surfaceless platform, then the default display.
std::unique_ptr<GlContext> make_egl_context() {
  std::vector<std::string> attempts;  // result of each
  std::unique_ptr<GlContext> context;
  const auto is_open = [&](EGLDisplay display, const char* way, const std::string& name) {
    try {
      context = std::make_unique<EglContext>(display, way);
    } catch (const Error& error) {
      attempts.push_back(name + ": " + error.what());
    }
    return context != nullptr;
  };
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
    if (!query_devices(16, devices, &device_count))
      attempts.push_back("device platform: eglQueryDevicesEXT: " + egl_error());
    else if (device_count == 0)
      attempts.emplace_back("device platform: no device");
    for (EGLint i = 0; i < device_count; ++i)
      if (is_open(get_platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr), "EGL device",
                  fmt::format("device {}", i)))
        return context;
  }

  if (get_platform_display == nullptr || !has_client_extension("EGL_MESA_platform_surfaceless"))
    attempts.emplace_back("surfaceless platform: not supported");
  else if (is_open(
               get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
               "EGL surfaceless", "surfaceless platform"))
    return context;
  if (is_open(eglGetDisplay(EGL_DEFAULT_DISPLAY), "EGL default display", "default display"))
    return context;

  throw Error(
      fmt::format("no OpenGL 3.3 core context through EGL: {} (Debian: libegl1, libopengl0, and "
                  "libgl1-mesa-dri provide a software renderer)",
                  fmt::join(attempts, "; ")));
}

namespace {

std::string glfw_answer() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

/// Only one at a time, because destroying it terminates GLFW.
class GlfwContext : public GlContext {
 public:
  GlfwContext(int width, int height, const std::string& title, bool visible) {
    if (!glfwInit()) throw Error("cannot open a window: " + glfw_answer());
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, visible);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_TRUE);
    // Window class for desktop environments; matches planescope.desktop.
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "planescope");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "planescope");
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);  // same apparent size at any pixel density
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
      const std::string answer = glfw_answer();
      glfwTerminate();
      throw Error("cannot open a window with OpenGL 3.3 core: " + answer);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);  // at most the screen's refresh rate
    description_ = gl_description() + ", GLFW window";
  }
  ~GlfwContext() override { glfwTerminate(); }  // also destroys the window
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
