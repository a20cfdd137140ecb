#include "app/desktop/offscreen.hpp"

#include <backends/imgui_impl_opengl3.h>

#include "core/io/image/png.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {

struct Offscreen::Target {
  render::GlRenderbuffer color = render::make_renderbuffer();
  render::GlFramebuffer framebuffer = render::make_framebuffer();
};

Offscreen::Offscreen(State state, int width, int height, float scale)
    : width_(width), height_(height), scale_(scale), context_(render::make_egl_context()) {
  target_ = std::make_unique<Target>();
  glBindFramebuffer(GL_FRAMEBUFFER, target_->framebuffer);
  glBindRenderbuffer(GL_RENDERBUFFER, target_->color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target_->color);
  render::check_gl("making the off-screen window");
  shell_ = std::make_unique<Shell>(std::move(state), make_gl_canvas(), [] {});
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Offscreen::~Offscreen() {
  context_->make_current();
  ImGui::SetCurrentContext(shell_->context());
  ImGui_ImplOpenGL3_Shutdown();
  shell_.reset();
  target_.reset();
}

void Offscreen::draw_frame() {
  context_->make_current();
  glBindFramebuffer(GL_FRAMEBUFFER, target_->framebuffer);
  shell_->frame(width_, height_, scale_, 1.0 / 60);
  if (shell_->take_fonts_changed()) {
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  ImGui_ImplOpenGL3_NewFrame();
  glBindFramebuffer(GL_FRAMEBUFFER, target_->framebuffer);
  glViewport(0, 0, width_, height_);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Offscreen::finish() {
  context_->make_current();
  glFinish();
}

Image8 Offscreen::picture() {
  context_->make_current();
  glBindFramebuffer(GL_FRAMEBUFFER, target_->framebuffer);
  Image8 image = render::read_picture(width_, height_);
  render::check_gl("reading the off-screen window");
  return image;
}

void Offscreen::screenshot(const std::filesystem::path& path) { io::write_png(path, picture()); }

}  // namespace planescope::desktop
