#pragma once

// Compatibility with Dear ImGui 1.86 to 1.92. All version checks are in this file.

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <cstdint>

namespace planescope::desktop {

// Converts between a texture name and AddImage()'s type, which is a pointer before 1.91.4 and an
// integer since. C-style casts work for both. NOLINTBEGIN
inline ImTextureID imgui_texture(std::uintptr_t texture) { return (ImTextureID)texture; }
inline std::uintptr_t texture_name(ImTextureID texture) { return (std::uintptr_t)texture; }
// NOLINTEND

/// Copies the texture of a command.
inline void copy_texture(ImDrawCmd& to, const ImDrawCmd& from) {
#if IMGUI_VERSION_NUM >= 19200
  to.TexRef = from.TexRef;
#else
  to.TextureId = from.TextureId;
#endif
}

/// Makes `list` the only draw list of a frame. Must live until the frame is drawn.
struct OneDrawList {
  ImDrawList* lists[1] = {};

  template <typename Frame>  // ImDrawData: CmdLists is an array, since 1.89.8 an ImVector
  void make_all_of(Frame& frame, ImDrawList& list) {
    if constexpr (requires { frame.CmdLists.clear(); }) {
      frame.CmdLists.clear();
      frame.CmdLists.push_back(&list);
    } else {
      lists[0] = &list;
      frame.CmdLists = lists;
    }
    frame.CmdListsCount = 1;
    frame.TotalVtxCount = list.VtxBuffer.Size;
    frame.TotalIdxCount = list.IdxBuffer.Size;
  }
};

/// Horizontal scroll offset of a text input [px].
template <typename Input>  // ImGuiInputTextState
float scrolled_right(const Input& input) {
  if constexpr (requires { input.Scroll; })
    return input.Scroll.x;
  else
    return input.ScrollX;
}

/// Builds the atlas after fonts were added. Renderers since 1.92 do this while drawing.
inline void build_fonts(ImFontAtlas& atlas) {
#if IMGUI_VERSION_NUM >= 19200
  if ((ImGui::GetIO().BackendFlags & ImGuiBackendFlags_RendererHasTextures) != 0) return;
#endif
  atlas.Build();
}

/// Uploads atlas changes to OpenGL before a frame is drawn; returns whether there were any.
inline bool update_font_texture(const ImDrawData& frame, bool fonts_changed) {
#if IMGUI_VERSION_NUM >= 19200
  if (frame.Textures != nullptr)
    for (ImTextureData* texture : *frame.Textures) {
      if (texture->Status == ImTextureStatus_OK) continue;
      ImGui_ImplOpenGL3_UpdateTexture(texture);
      fonts_changed = true;
    }
#else
  (void)frame;
  if (fonts_changed) {
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
#endif
  return fonts_changed;
}

/// Text height of a font [px].
inline float height_of(const ImFont& font) {
#if IMGUI_VERSION_NUM >= 19200
  return font.LegacySize;
#else
  return font.FontSize;
#endif
}

/// Enables moving among widgets with arrow keys, Space and Enter, with a visible focus.
inline void set_navigation(ImGuiIO& io, bool on) {
  const bool was = (io.ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) != 0;
  if (on == was) return;
  io.ConfigFlags ^= ImGuiConfigFlags_NavEnableKeyboard;
  ImGuiContext& context = *ImGui::GetCurrentContext();
  if constexpr (requires { context.NavDisableHighlight; }) context.NavDisableHighlight = !on;
}

/// Whether a key of ImGui's own widgets was pressed in this frame or is repeating.
inline bool went_down(ImGuiKey key, bool repeat = true) {
#if IMGUI_VERSION_NUM >= 18700
  return ImGui::IsKeyPressed(key, repeat);
#else
  return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeat);
#endif
}

}  // namespace planescope::desktop
