#pragma once

// Dear ImGui as its versions from 1.86 to 1.92 have it, told apart here and nowhere else.

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <cstdint>

namespace planescope::desktop {

// A texture's name as AddImage() takes it, and back: a pointer by name only, since 1.91.4 a number.
// Casts of C's do both. NOLINTBEGIN
inline ImTextureID imgui_texture(std::uintptr_t texture) { return (ImTextureID)texture; }
inline std::uintptr_t texture_name(ImTextureID texture) { return (std::uintptr_t)texture; }
// NOLINTEND

/// Gives a command the texture of another.
inline void copy_texture(ImDrawCmd& to, const ImDrawCmd& from) {
#if IMGUI_VERSION_NUM >= 19200
  to.TexRef = from.TexRef;
#else
  to.TextureId = from.TextureId;
#endif
}

/// Makes `list` all that a frame draws; keeps room for it until the frame is drawn.
struct OneDrawList {
  ImDrawList* lists[1] = {};

  template <typename Frame>  // ImDrawData: its lists are an array, since 1.89.8 an ImVector
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

/// How far the text of an input is scrolled to the right [px].
template <typename Input>  // ImGuiInputTextState
float scrolled_right(const Input& input) {
  if constexpr (requires { input.Scroll; })
    return input.Scroll.x;
  else
    return input.ScrollX;
}

/// After fonts were added to the empty atlas. Renderers since 1.92 do this as they draw.
inline void build_fonts(ImFontAtlas& atlas) {
#if IMGUI_VERSION_NUM >= 19200
  if ((ImGui::GetIO().BackendFlags & ImGuiBackendFlags_RendererHasTextures) != 0) return;
#endif
  atlas.Build();
}

/// Hands what the atlas holds to OpenGL, in a frame that is about to be drawn: whether it changed.
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

/// The height of a font's text [px].
inline float height_of(const ImFont& font) {
#if IMGUI_VERSION_NUM >= 19200
  return font.LegacySize;
#else
  return font.FontSize;
#endif
}

/// Whether arrow keys, Space and Enter move among widgets and use them, with a visible cursor.
inline void set_navigation(ImGuiIO& io, bool on) {
  const bool was = (io.ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) != 0;
  if (on == was) return;
  io.ConfigFlags ^= ImGuiConfigFlags_NavEnableKeyboard;
  ImGuiContext& context = *ImGui::GetCurrentContext();
  if constexpr (requires { context.NavDisableHighlight; }) context.NavDisableHighlight = !on;
}

/// A key of ImGui's own widgets went down in this frame, or repeats.
inline bool went_down(ImGuiKey key, bool repeat = true) {
#if IMGUI_VERSION_NUM >= 18700
  return ImGui::IsKeyPressed(key, repeat);
#else
  return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeat);
#endif
}

}  // namespace planescope::desktop
