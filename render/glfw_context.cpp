// A window of its own and its GL context. Needs a display server.

#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <mutex>

#include "core/model/error.hpp"
#include "render/context.hpp"
#include "render/gl.hpp"

namespace planescope::render {
namespace {

std::string glfw_answer() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

// GLFW is initialised once per process and ended with the last window.
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
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);  // as large to the eye at any pixel density
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
