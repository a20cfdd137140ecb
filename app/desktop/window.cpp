// GLFW window, and the offscreen stage that draws the same shell without a display.

#define GLFW_INCLUDE_NONE

#include "app/desktop/window.hpp"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/desktop/state/state.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {

namespace {

using Clock = std::chrono::steady_clock;

// ---- On a display ------------------------------------------------------------------------------

Key key_of_glfw(int key) {
  if ((key >= GLFW_KEY_A && key <= GLFW_KEY_Z) || (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) ||
      key == GLFW_KEY_SPACE || key == GLFW_KEY_MINUS || key == GLFW_KEY_EQUAL ||
      key == GLFW_KEY_PERIOD || key == GLFW_KEY_LEFT_BRACKET || key == GLFW_KEY_RIGHT_BRACKET)
    return static_cast<Key>(key);
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12)
    return static_cast<Key>(static_cast<int>(Key::f1) + key - GLFW_KEY_F1);
  static constexpr std::pair<int, Key> kOthers[] = {
      {GLFW_KEY_LEFT, Key::left},
      {GLFW_KEY_RIGHT, Key::right},
      {GLFW_KEY_UP, Key::up},
      {GLFW_KEY_DOWN, Key::down},
      {GLFW_KEY_HOME, Key::home},
      {GLFW_KEY_END, Key::end},
      {GLFW_KEY_PAGE_UP, Key::page_up},
      {GLFW_KEY_PAGE_DOWN, Key::page_down},
      {GLFW_KEY_INSERT, Key::insert},
      {GLFW_KEY_DELETE, Key::del},
      {GLFW_KEY_BACKSPACE, Key::backspace},
      {GLFW_KEY_ENTER, Key::enter},
      {GLFW_KEY_KP_ENTER, Key::enter},
      {GLFW_KEY_ESCAPE, Key::escape},
      {GLFW_KEY_TAB, Key::tab},
      {GLFW_KEY_KP_ADD, static_cast<Key>('=')},
      {GLFW_KEY_KP_SUBTRACT, static_cast<Key>('-')},
      {GLFW_KEY_LEFT_CONTROL, Key::ctrl},
      {GLFW_KEY_RIGHT_CONTROL, Key::ctrl},
      {GLFW_KEY_LEFT_SHIFT, Key::shift},
      {GLFW_KEY_RIGHT_SHIFT, Key::shift},
      {GLFW_KEY_LEFT_ALT, Key::alt},
      {GLFW_KEY_RIGHT_ALT, Key::alt},
  };
  for (const auto& [theirs, ours] : kOthers)
    if (key == theirs) return ours;
  return Key::none;
}

/// Statistics of recent frame times, for the overlay.
class Stopwatch {
 public:
  void add(double ms, FrameTimes& times) {
    lately_.push_back(ms);
    if (lately_.size() > 240) lately_.erase(lately_.begin());
    std::vector<double> sorted = lately_;
    std::sort(sorted.begin(), sorted.end());
    times = {ms, sorted[sorted.size() / 2], sorted[sorted.size() * 99 / 100]};
  }

 private:
  std::vector<double> lately_;
};

class Window : public Stage {
 public:
  Window(State state, const WindowOptions& options);
  ~Window() override;
  void run(std::stop_token stop);
  void draw_frame() override;
  Image8 picture() override;

 private:
  static Window& of(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
  }
  Shell& shell() const { return screen_->shell(); }
  void push(const InputEvent& event) { shell().input().push(event); }
  void connect();
  void show_cursor();
  void write_state();
  void keep_settings() const;
  float scale() const;

  const WindowOptions& options_;
  std::unique_ptr<render::GlContext> context_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<Screen> screen_;
  GLFWcursor* cursors_[ImGuiMouseCursor_COUNT] = {};
  std::string title_, written_;
  Stopwatch stopwatch_;
  Clock::time_point last_ = Clock::now();
};

Window::Window(State state, const WindowOptions& options) : options_(options) {
  try {
    context_ = render::make_glfw_context(options.settings.width, options.settings.height,
                                         "planescope", true);
  } catch (const Error& error) {
    throw NoDisplay(error.what());
  }
  window_ = context_->window();
  if (options.settings.maximized) glfwMaximizeWindow(window_);
  glfwSetWindowSizeLimits(window_, 640, 400, GLFW_DONT_CARE, GLFW_DONT_CARE);
  screen_ = std::make_unique<Screen>(std::move(state), [] { glfwPostEmptyEvent(); });
  ImGuiIO& io = ImGui::GetIO();
  io.SetClipboardTextFn = [](void* window, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(window), text);
  };
  io.GetClipboardTextFn = [](void* window) {
    return glfwGetClipboardString(static_cast<GLFWwindow*>(window));
  };
  io.ClipboardUserData = window_;
  io.BackendFlags |= ImGuiBackendFlags_HasMouseCursors;
  cursors_[ImGuiMouseCursor_Arrow] = glfwCreateStandardCursor(GLFW_ARROW_CURSOR);
  cursors_[ImGuiMouseCursor_TextInput] = glfwCreateStandardCursor(GLFW_IBEAM_CURSOR);
  cursors_[ImGuiMouseCursor_ResizeEW] = glfwCreateStandardCursor(GLFW_HRESIZE_CURSOR);
  cursors_[ImGuiMouseCursor_ResizeNS] = glfwCreateStandardCursor(GLFW_VRESIZE_CURSOR);
  cursors_[ImGuiMouseCursor_Hand] = glfwCreateStandardCursor(GLFW_HAND_CURSOR);
  connect();
}

Window::~Window() {
  if (options_.keep_settings) keep_settings();
  screen_.reset();
  for (GLFWcursor* cursor : cursors_)
    if (cursor) glfwDestroyCursor(cursor);
}

void Window::connect() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
    // On high-DPI screens the framebuffer has more pixels than the window has units.
    int width = 1, height = 1, pixels_x = 1, pixels_y = 1;
    glfwGetWindowSize(w, &width, &height);
    glfwGetFramebufferSize(w, &pixels_x, &pixels_y);
    of(w).push({.type = InputEvent::Type::move,
                .x = static_cast<float>(x * pixels_x / std::max(1, width)),
                .y = static_cast<float>(y * pixels_y / std::max(1, height))});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
    if (button < 3)
      of(w).push(
          {.type = InputEvent::Type::button, .button = button, .down = action == GLFW_PRESS});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double x, double y) {
    of(w).push(
        {.type = InputEvent::Type::wheel, .x = static_cast<float>(x), .y = static_cast<float>(y)});
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) {
    if (const Key ours = key_of_glfw(key); ours != Key::none)
      of(w).push({.type = InputEvent::Type::key, .down = action != GLFW_RELEASE, .key = ours});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned c) {
    of(w).push({.type = InputEvent::Type::text, .character = static_cast<char32_t>(c)});
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    for (int i = 0; i < count; ++i) of(w).shell().drop(paths[i]);
  });
}

float Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max(x, y);
}

void Window::draw_frame() {
  glfwPollEvents();
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  if (width == 0 || height == 0) return;  // minimized
  take_step(
      shell(), [&] { screen_->draw(width, height, scale(), 0); }, [this] { return picture(); });
  screen_->draw(width, height, scale(), std::min(seconds, 0.1));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, screen_->framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  stopwatch_.add(std::chrono::duration<double, std::milli>(Clock::now() - now).count(),
                 shell().timing);
  glfwSwapBuffers(window_);
  take_picture(shell(), *this);
  show_cursor();
  if (!options_.state_file.empty()) write_state();
  const OpenRecording* open = shell().state().document.current();
  const std::string title = open ? open->path.filename().string() + " – planescope" : "planescope";
  if (title != title_) glfwSetWindowTitle(window_, (title_ = title).c_str());
}

void Window::show_cursor() {
  GLFWcursor* cursor = cursors_[std::max(0, ImGui::GetMouseCursor())];
  glfwSetCursor(window_, cursor ? cursor : cursors_[ImGuiMouseCursor_Arrow]);
}

void Window::write_state() {
  const std::string facts = state_text(shell().state(), shell().idle());
  if (facts == written_) return;
  written_ = facts;
  write_file_text(options_.state_file, facts);
}

/// Reads the persistent framebuffer, because the contents of the display may not be readable.
Image8 Window::picture() {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  glBindFramebuffer(GL_FRAMEBUFFER, screen_->framebuffer());
  Image8 image = render::read_picture(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

void Window::keep_settings() const {
  Settings settings = options_.settings;
  const State& state = shell().state();
  settings.maximized = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) == GLFW_TRUE;
  if (!settings.maximized) glfwGetWindowSize(window_, &settings.width, &settings.height);
  if (const OpenRecording* open = state.document.current()) {
    std::error_code gone;  // the folder that a relative path starts from
    settings.last_recording = std::filesystem::absolute(open->path, gone);
    settings.last_frame = state.document.frame;
  }
  settings.recent = state.document.recent;
  settings.camera = state.view.camera;
  settings.view = state.view;
  settings.view.truth_plane = 0;  // belongs to the current recording
  if (state.view.case_colors == CaseColors::shown)
    settings.view.color_by = render::ColorBy::planes;  // case colors end with stepping
  save_settings(settings);
}

void Window::run(std::stop_token stop) {
  const std::stop_callback wake(stop, [] { glfwPostEmptyEvent(); });
  for (const Script& script : options_.scripts) script.play(shell(), *this, stop);
  while (!glfwWindowShouldClose(window_) && !shell().state().view.quit && !stop.stop_requested()) {
    // Draw nothing until something happens; finished jobs wake the window.
    const bool expires = shell().expire_message();
    if (shell().idle() && !expires)
      glfwWaitEvents();
    else if (shell().idle())
      glfwWaitEventsTimeout(1);
    else if (!shell().needs_frame() || glfwGetWindowAttrib(window_, GLFW_ICONIFIED))
      glfwWaitEventsTimeout(0.1);
    draw_frame();
  }
}

}  // namespace

void run_window(State state, const WindowOptions& options, std::stop_token stop) {
  Window window(std::move(state), options);
  window.run(stop);
}

// ---- Without a display -------------------------------------------------------------------------

Offscreen::Offscreen(State state, int width, int height, float scale)
    : width_(width),
      height_(height),
      scale_(scale),
      context_(render::make_egl_context()),
      screen_(std::make_unique<Screen>(std::move(state), [] {})) {}

Offscreen::~Offscreen() {
  try {
    context_->make_current();
  } catch (const Error&) {
    // Drawing resources end with the context; labels are saved regardless.
  }
  screen_.reset();
}

void Offscreen::draw_frame() {
  context_->make_current();
  // No display limits the frame rate: a software renderer would queue dozens of frames of tens of
  // megabytes each.
  glFinish();
  take_step(
      shell(), [this] { screen_->draw(width_, height_, scale_, 0); }, [this] { return picture(); });
  screen_->draw(width_, height_, scale_, 1.0 / 60);
  take_picture(screen_->shell(), *this);
}

void Offscreen::finish() {
  context_->make_current();
  glFinish();
}

Image8 Offscreen::picture() {
  context_->make_current();
  glBindFramebuffer(GL_FRAMEBUFFER, screen_->framebuffer());
  Image8 image = render::read_picture(width_, height_);
  render::check_gl("reading the off-screen window");
  return image;
}

void Stage::screenshot(const std::filesystem::path& path, const std::optional<WidgetRect>& part) {
  const Image8 whole = picture();
  io::write_png(path, part ? part_of(whole, *part) : whole);
}

Image8 part_of(const Image8& whole, const WidgetRect& rect) {
  const auto within = [](float at, int most) { return std::clamp(static_cast<int>(at), 0, most); };
  const int x0 = within(rect.min.x, whole.width), x1 = within(rect.max.x, whole.width);
  const int y0 = within(rect.min.y, whole.height), y1 = within(rect.max.y, whole.height);
  Image8 part(std::max(1, x1 - x0), std::max(1, y1 - y0), whole.channels);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      for (int c = 0; c < whole.channels; ++c) part.at(x - x0, y - y0, c) = whole.at(x, y, c);
  return part;
}

namespace {

using render::common;
using render::hashed;
using render::whole_px;

/// Pixels that a command may touch, rounded like in ImGui's OpenGL renderer.
Part scissor(const ImVec4& clip, int height) {
  const int left = static_cast<int>(clip.x);
  const int below = static_cast<int>(static_cast<float>(height) - clip.w);
  const int w = static_cast<int>(clip.z - clip.x), h = static_cast<int>(clip.w - clip.y);
  return {left, height - below - h, left + w, height - below};
}

using Triangle = std::array<ImDrawVert, 3>;

/// Pixels that the triangle may touch.
Part bounds(const Triangle& t) {
  const auto [x0, x1] = std::minmax({t[0].pos.x, t[1].pos.x, t[2].pos.x});
  const auto [y0, y1] = std::minmax({t[0].pos.y, t[1].pos.y, t[2].pos.y});
  return {whole_px(std::floor(x0)), whole_px(std::floor(y0)), whole_px(std::ceil(x1)),
          whole_px(std::ceil(y1))};
}

/// Visits commands in order, with the pixels that each may touch.
template <typename Visit>
void each_command(const ImDrawData& frame, Visit visit) {
  const int width = static_cast<int>(frame.DisplaySize.x);
  const int height = static_cast<int>(frame.DisplaySize.y);
  for (int i = 0; i < frame.CmdListsCount; ++i) {
    const ImDrawList& list = *frame.CmdLists[i];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const Part room = common(scissor(command.ClipRect, height), {0, 0, width, height});
      if (!room.empty()) visit(list, command, room);
    }
  }
}

template <typename Visit>
void each_triangle(const ImDrawList& list, const ImDrawCmd& command, Visit visit) {
  const ImDrawVert* vertices = list.VtxBuffer.Data + command.VtxOffset;
  const ImDrawIdx* index = list.IdxBuffer.Data + command.IdxOffset;
  for (unsigned i = 0; i + 2 < command.ElemCount; i += 3)
    visit(Triangle{vertices[index[i]], vertices[index[i + 1]], vertices[index[i + 2]]});
}

}  // namespace

std::vector<Part> Damage::next(const ImDrawData& frame,
                               const std::function<std::uint64_t(ImTextureID)>& version) {
  render::Tiles tiles(static_cast<int>(frame.DisplaySize.x), static_cast<int>(frame.DisplaySize.y));
  each_command(frame, [&](const ImDrawList& list, const ImDrawCmd& command, const Part& room) {
    const std::uint64_t texture = texture_name(command.GetTexID());
    const std::uint64_t start = hashed(1, room, texture, version(command.GetTexID()));
    each_triangle(list, command, [&](const Triangle& triangle) {
      tiles.add(common(bounds(triangle), room), hashed(start, triangle));
    });
  });
  std::vector<Part> parts = tiles.changes_since(tiles_);
  tiles_ = std::move(tiles);
  return parts;
}

void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut) {
  constexpr int kMost = 65535 / 3 * 3;  // indices per 16-bit command
  for (const Part& part : parts) {
    each_command(frame, [&](const ImDrawList& list, const ImDrawCmd& command, const Part& room) {
      const Part seen = common(room, part);
      if (seen.empty()) return;
      const auto begin = [&] {
        ImDrawCmd piece;
        piece.ClipRect = ImVec4(static_cast<float>(seen.x0), static_cast<float>(seen.y0),
                                static_cast<float>(seen.x1), static_cast<float>(seen.y1));
        copy_texture(piece, command);
        piece.VtxOffset = static_cast<unsigned>(cut.VtxBuffer.Size);
        piece.IdxOffset = static_cast<unsigned>(cut.IdxBuffer.Size);
        cut.CmdBuffer.push_back(piece);
      };
      begin();
      each_triangle(list, command, [&](const Triangle& triangle) {
        if (common(bounds(triangle), seen).empty()) return;
        if (cut.CmdBuffer.back().ElemCount == kMost) begin();
        ImDrawCmd& piece = cut.CmdBuffer.back();
        for (const ImDrawVert& vertex : triangle) {
          cut.VtxBuffer.push_back(vertex);
          cut.IdxBuffer.push_back(static_cast<ImDrawIdx>(piece.ElemCount++));
        }
      });
      if (cut.CmdBuffer.back().ElemCount == 0) cut.CmdBuffer.pop_back();
    });
  }
}

Screen::Screen(State state, std::function<void()> wake) {
  std::unique_ptr<Canvas> canvas = make_gl_canvas();
  canvas_ = canvas.get();
  shell_ = std::make_unique<Shell>(std::move(state), std::move(canvas), std::move(wake));
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Screen::~Screen() {
  ImGui::SetCurrentContext(shell_->context());
  ImGui_ImplOpenGL3_Shutdown();
}

void Screen::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glBindRenderbuffer(GL_RENDERBUFFER, color_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  render::check_gl("making the window's picture");
  width_ = width;
  height_ = height;
  forget();
}

void Screen::draw(int width, int height, float scale, double seconds) {
  resize(width, height);
  shell_->frame(width, height, scale, seconds);
  ImDrawData frame = *ImGui::GetDrawData();
  if (update_font_texture(frame, shell_->take_fonts_changed())) forget();
  ImGui_ImplOpenGL3_NewFrame();
  const std::vector<Part> parts = damage_.next(
      frame, [this](ImTextureID texture) { return canvas_->version(texture_name(texture)); });
  pixels_drawn_ = 0;
  if (parts.empty()) return;

  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);  // the views have drawn into others
  glViewport(0, 0, width, height);
  glEnable(GL_SCISSOR_TEST);
  glClearColor(0, 0, 0, 1);
  for (const Part& part : parts) {
    glScissor(part.x0, height - part.y1, part.x1 - part.x0, part.y1 - part.y0);
    glClear(GL_COLOR_BUFFER_BIT);
    pixels_drawn_ += std::int64_t{part.x1 - part.x0} * (part.y1 - part.y0);
  }
  glDisable(GL_SCISSOR_TEST);
  ImDrawList cut(ImGui::GetDrawListSharedData());
  cut_to_parts(frame, parts, cut);
  OneDrawList all;
  all.make_all_of(frame, cut);
  ImGui_ImplOpenGL3_RenderDrawData(&frame);
}

}  // namespace planescope::desktop
