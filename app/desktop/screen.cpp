#include "app/desktop/screen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace planescope::desktop {
namespace {

using render::common;
using render::hashed;
using render::whole_px;

/// The pixels that a command may touch, rounded as ImGui's OpenGL renderer rounds them.
Part scissor(const ImVec4& clip, int height) {
  const int left = static_cast<int>(clip.x);
  const int below = static_cast<int>(static_cast<float>(height) - clip.w);
  const int w = static_cast<int>(clip.z - clip.x), h = static_cast<int>(clip.w - clip.y);
  return {left, height - below - h, left + w, height - below};
}

using Triangle = std::array<ImDrawVert, 3>;

/// The pixels that it may touch.
Part bounds(const Triangle& t) {
  const auto [x0, x1] = std::minmax({t[0].pos.x, t[1].pos.x, t[2].pos.x});
  const auto [y0, y1] = std::minmax({t[0].pos.y, t[1].pos.y, t[2].pos.y});
  return {whole_px(std::floor(x0)), whole_px(std::floor(y0)), whole_px(std::ceil(x1)),
          whole_px(std::ceil(y1))};
}

/// Commands in their order, with the pixels that each may touch.
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
  constexpr int kMost = 65535 / 3 * 3;  // vertices that 16 bits can count
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
