#include "app/desktop/ui.hpp"

namespace planescope::desktop {
namespace {

ImVec4 rgb(int hex, float alpha = 1) {
  return ImVec4(static_cast<float>(hex >> 16 & 255) / 255, static_cast<float>(hex >> 8 & 255) / 255,
                static_cast<float>(hex & 255) / 255, alpha);
}

/// Every text contrasts with every ground that it may stand on by 4.5 : 1 (WCAG AA).
struct Scheme {
  int window, child, popup, frame, frame_hot, border, text, muted, accent, header;
};
constexpr Scheme kDark = {0x1b1e23, 0x16181c, 0x23272d, 0x2a2f37, 0x363c46,
                          0x343a43, 0xe6e9ed, 0xa8b0bb, 0x5fb0ea, 0x24405a};
constexpr Scheme kLight = {0xf6f7f9, 0xffffff, 0xffffff, 0xe6e9ee, 0xd6dbe3,
                           0xcdd2da, 0x1c2026, 0x535a64, 0x0c5ca3, 0xcfe3f6};

}  // namespace

void Ui::name(const std::string& widget) const {
  name(widget, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
}

void Ui::name(const std::string& widget, ImVec2 min, ImVec2 max) const {
  widgets[widget] = {min, max};
}

void set_style(render::Theme theme, float scale) {
  const Scheme& s = theme == render::Theme::dark ? kDark : kLight;
  ImGuiStyle style;
  style.WindowPadding = ImVec2(8, 6);
  style.FramePadding = ImVec2(6, 3);
  style.ItemSpacing = ImVec2(7, 4);
  style.ItemInnerSpacing = ImVec2(5, 4);
  style.CellPadding = ImVec2(5, 2);
  style.ScrollbarSize = 11;
  style.GrabMinSize = 12;  // the thumb of a long list can still be taken hold of
  style.IndentSpacing = 16;
  style.WindowRounding = 0;
  style.ChildRounding = 0;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.TabRounding = 3;
  style.ScrollbarRounding = 6;
  style.PopupRounding = 4;
  style.WindowBorderSize = 1;
  style.ChildBorderSize = 1;
  style.PopupBorderSize = 1;
  style.ScaleAllSizes(scale);

  const ImVec4 accent = rgb(s.accent);
  const auto faint = [&](float alpha) { return rgb(s.accent, alpha); };
  ImVec4* c = style.Colors;
  for (int i = 0; i < ImGuiCol_COUNT; ++i) c[i] = rgb(s.text);
  c[ImGuiCol_TextDisabled] = rgb(s.muted);
  c[ImGuiCol_WindowBg] = rgb(s.window);
  c[ImGuiCol_ChildBg] = rgb(s.child);
  c[ImGuiCol_PopupBg] = rgb(s.popup);
  c[ImGuiCol_Border] = rgb(s.border);
  c[ImGuiCol_BorderShadow] = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_FrameBg] = rgb(s.frame);
  c[ImGuiCol_FrameBgHovered] = rgb(s.frame_hot);
  c[ImGuiCol_FrameBgActive] = rgb(s.frame_hot);
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = c[ImGuiCol_TitleBgCollapsed] = rgb(s.window);
  c[ImGuiCol_MenuBarBg] = rgb(s.window);
  c[ImGuiCol_ScrollbarBg] = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_ScrollbarGrab] = rgb(s.frame_hot);
  c[ImGuiCol_ScrollbarGrabHovered] = c[ImGuiCol_ScrollbarGrabActive] = rgb(s.muted);
  c[ImGuiCol_CheckMark] = accent;
  c[ImGuiCol_SliderGrab] = accent;
  c[ImGuiCol_SliderGrabActive] = accent;
  c[ImGuiCol_Button] = rgb(s.frame);
  c[ImGuiCol_ButtonHovered] = rgb(s.frame_hot);
  c[ImGuiCol_ButtonActive] = faint(0.5f);
  c[ImGuiCol_Header] = rgb(s.header);
  c[ImGuiCol_HeaderHovered] = faint(0.25f);
  c[ImGuiCol_HeaderActive] = faint(0.4f);
  c[ImGuiCol_Separator] = rgb(s.border);
  c[ImGuiCol_SeparatorHovered] = c[ImGuiCol_SeparatorActive] = accent;
  c[ImGuiCol_ResizeGrip] = c[ImGuiCol_ResizeGripHovered] = c[ImGuiCol_ResizeGripActive] =
      ImVec4(0, 0, 0, 0);
  c[ImGuiCol_Tab] = rgb(s.window);
  c[ImGuiCol_TabHovered] = faint(0.35f);
  c[ImGuiCol_TabActive] = c[ImGuiCol_TabUnfocusedActive] = rgb(s.header);
  c[ImGuiCol_TabUnfocused] = rgb(s.window);
  c[ImGuiCol_PlotLines] = c[ImGuiCol_PlotHistogram] = accent;
  c[ImGuiCol_PlotLinesHovered] = c[ImGuiCol_PlotHistogramHovered] = accent;
  c[ImGuiCol_TableHeaderBg] = rgb(s.window);
  c[ImGuiCol_TableBorderStrong] = c[ImGuiCol_TableBorderLight] = rgb(s.border);
  c[ImGuiCol_TableRowBg] = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_TableRowBgAlt] = rgb(s.text, 0.03f);
  c[ImGuiCol_TextSelectedBg] = faint(0.35f);
  c[ImGuiCol_DragDropTarget] = c[ImGuiCol_NavHighlight] = accent;
  c[ImGuiCol_NavWindowingHighlight] = c[ImGuiCol_NavWindowingDimBg] = c[ImGuiCol_ModalWindowDimBg] =
      ImVec4(0, 0, 0, 0.4f);
  ImGui::GetStyle() = style;
}

UiColors ui_colors(render::Theme theme) {
  const Scheme& s = theme == render::Theme::dark ? kDark : kLight;
  const auto color = [](int hex, float alpha = 1) {
    return ImGui::ColorConvertFloat4ToU32(rgb(hex, alpha));
  };
  const bool dark = theme == render::Theme::dark;
  return {.text = color(s.text),
          .muted = color(s.muted),
          .accent = color(s.accent),
          .good = color(dark ? 0x35c28b : 0x00704f),
          .bad = color(dark ? 0xff9175 : 0xb03500),
          .warning = color(dark ? 0xf0c04a : 0x875a00),
          .grid = color(s.border),
          .panel = color(s.child)};
}

}  // namespace planescope::desktop
