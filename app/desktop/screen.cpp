#include "app/desktop/screen.hpp"

namespace planescope::desktop {

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
