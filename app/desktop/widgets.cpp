// Styles and basic widgets of the panels: text, links, tooltips, buttons, tables and lists.

#include "app/desktop/widgets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "render/palette.hpp"

namespace planescope::desktop {

// ---- Style --------------------------------------------------------------------------------------

namespace {

ImVec4 rgb(int hex, float alpha = 1) {
  return ImVec4(static_cast<float>(hex >> 16 & 255) / 255, static_cast<float>(hex >> 8 & 255) / 255,
                static_cast<float>(hex & 255) / 255, alpha);
}

/// All text has a contrast of at least 4.5:1 with every background it is used on (WCAG AA).
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
  style.GrabMinSize = 12;  // keeps the thumb of a long list easy to grab
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

// ---- Widgets ------------------------------------------------------------------------------------

namespace {

constexpr float kSubscriptSize = 0.78f;  // fraction of the text size
constexpr float kSubscriptDrop = 0.34f;  // fraction of the text height

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// Whether the underscore follows a symbol, i.e. a single letter. Underscores in option names do
/// not.
bool is_subscript(const std::string& text, std::size_t mark) {
  if (mark == 0 || mark + 1 == text.size() || !is_word(text[mark + 1])) return false;
  std::size_t letter = mark - 1;
  while (letter > 0 && (text[letter] & 0xc0) == 0x80) --letter;  // first byte of UTF-8
  const bool is_letter = is_word(text[letter]) || (text[letter] & 0x80) != 0;
  return is_letter && (letter == 0 || (!is_word(text[letter - 1]) && text[letter - 1] != '_'));
}

/// Calls `part(begin, end, is_subscript)` for the parts of the text, without the underscores.
template <typename Part>
void for_parts(const std::string& text, const Part& part) {
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::size_t mark = text.find('_', begin);
    while (mark != std::string::npos && !is_subscript(text, mark)) mark = text.find('_', mark + 1);
    if (mark == std::string::npos) return part(begin, text.size(), false);
    part(begin, mark, false);
    std::size_t end = mark + 1;
    while (end < text.size() && is_word(text[end])) ++end;
    part(mark + 1, end, true);
    begin = end;
  }
}

float width_of(
    const Ui& ui, const std::string& text, std::size_t begin, std::size_t end, bool sub) {
  // ImGui::CalcTextSize() rounds up, which would leave gaps between parts.
  ImFont& font = sub ? *ui.small : *ImGui::GetFont();
  const float size = ImGui::GetFontSize() * (sub ? kSubscriptSize : 1);
  const char* data = text.data();
  return font.CalcTextSizeA(size, 1e6f, 0, data + begin, data + end).x;
}

/// Breaks lines at spaces only: ImGui would also break between "9." and "15".
std::string wrapped(const std::string& text, float width) {
  std::string lines;
  std::size_t line = 0;  // start of the last line in `lines`
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = lines.substr(line) + (lines.size() > line ? " " : "") + word;
    if (lines.size() > line && ImGui::CalcTextSize(longer.c_str()).x > width) {
      lines += '\n';
      line = lines.size();
      lines += word;
    } else {
      lines.replace(line, std::string::npos, longer);
    }
    begin = end + 1;
  }
  return lines;
}

}  // namespace

// ---- Colors ------------------------------------------------------------------------------------

ImU32 to_imgui(render::Rgba color) { return IM_COL32(color.r, color.g, color.b, color.a); }

ImU32 with_alpha(ImU32 color, int alpha) {
  return (color & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, alpha);
}

ImU32 text_on(render::Rgba fill) {
  const bool light = 0.299 * fill.r + 0.587 * fill.g + 0.114 * fill.b > 140;
  return light ? IM_COL32(20, 22, 26, 255) : IM_COL32(255, 255, 255, 255);
}

ImU32 gain_color(const Ui& ui, int gain) {
  return gain > 0 ? ui.colors.good : gain < 0 ? ui.colors.bad : ui.colors.text;
}

// ---- Text --------------------------------------------------------------------------------------

void colored(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
}

void paragraph(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0);
  // ImGui breaks words that are wider than the room, such as paths.
  ImGui::TextUnformatted(wrapped(text, ImGui::GetContentRegionAvail().x).c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void heading(const Ui& ui, const std::string& text) {
  ImGui::PushFont(ui.bold);
  ImGui::PushTextWrapPos();
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
}

void fact(const Ui& ui, const char* what, const std::string& value) {
  ImGui::TextDisabled("%s", what);
  ImGui::SameLine(ui.px(92));
  paragraph(ui.colors.text, value);
}

bool link(const Ui& ui, const std::string& text, const std::string& widget) {
  paragraph(ui.colors.accent, text);
  ui.name(widget);
  if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  return ImGui::IsItemClicked();
}

namespace {

/// Shows a tooltip below an area or, near the lower edge of the window, above it.
void tooltip_beside(const std::string& text, ImVec2 min, ImVec2 max) {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const float gap = ImGui::GetFontSize() * 0.4f, wrap = ImGui::GetFontSize() * 32;
  const bool above = max.y > 0.75f * window.y;
  const bool leftwards = min.x > 0.6f * window.x;
  ImGui::SetNextWindowPos(ImVec2(leftwards ? max.x : min.x, above ? min.y - gap : max.y + gap),
                          ImGuiCond_Always, ImVec2(leftwards ? 1.0f : 0.0f, above ? 1.0f : 0.0f));
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(wrap);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace

void tooltip(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  if (max.y - min.y > 4 * ImGui::GetFontSize()) return tooltip_at_mouse(text);
  // For wide items, place it beside the part under the mouse.
  const float from = std::max(min.x, ImGui::GetIO().MousePos.x - ImGui::GetFontSize() * 6);
  tooltip_beside(text, ImVec2(from, min.y), ImVec2(std::min(max.x, from + 200), max.y));
}

void tooltip_at_mouse(const std::string& text) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const float reach = ImGui::GetFontSize() * 1.4f;
  tooltip_beside(text, ImVec2(mouse.x - reach, mouse.y - reach),
                 ImVec2(mouse.x + reach, mouse.y + reach));
}

void draw_notice(const Ui& ui, const std::string& text, ImU32 color) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float wrap = std::min(room.x, ui.px(420));
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const ImVec2 at = ImGui::GetCursorPos();
  ImGui::SetCursorPos(
      ImVec2(at.x + (room.x - size.x) / 2, at.y + std::max(0.0f, room.y - size.y) / 2));
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + wrap);
  colored(color, text);
  ImGui::PopTextWrapPos();
}

void case_badge(const Ui& ui, planes::Case c) {
  const float height = ImGui::GetTextLineHeight();
  const ImVec2 size(height * 1.5f, height);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), to_imgui(render::case_color(c)),
                      ui.px(3));
  const char* text = planes::to_string(c);
  const ImVec2 extent = ImGui::CalcTextSize(text);
  draw->AddText(ImVec2(at.x + (size.x - extent.x) / 2, at.y + (size.y - extent.y) / 2),
                text_on(render::case_color(c)), text);
  ImGui::Dummy(size);
}

float math_width(const Ui& ui, const std::string& text) {
  float width = 0;
  for_parts(text, [&](std::size_t begin, std::size_t end, bool sub) {
    width += width_of(ui, text, begin, end, sub);
  });
  return width;
}

std::string fitted(const Ui& ui, const std::string& text, float room) {
  return shortened(text, [&](const std::string& part) { return math_width(ui, part) <= room; });
}

void draw_math(const Ui& ui, ImDrawList* draw, ImVec2 at, ImU32 color, const std::string& text) {
  const float height = ImGui::GetFontSize();
  for_parts(text, [&](std::size_t begin, std::size_t end, bool sub) {
    const char* data = text.data();
    if (sub)
      draw->AddText(ui.small, height * kSubscriptSize,
                    ImVec2(std::round(at.x), std::round(at.y + height * kSubscriptDrop)), color,
                    data + begin, data + end);
    else
      draw->AddText(at, color, data + begin, data + end);
    at.x += width_of(ui, text, begin, end, sub);
  });
}

void math_text(const Ui& ui, ImU32 color, const std::string& text) {
  ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::ceil(math_width(ui, text)), ImGui::GetTextLineHeight());
  // Align with text beside a button or a frame.
  at.y += ImGui::GetCurrentWindowRead()->DC.CurrLineTextBaseOffset;
  ImGui::Dummy(size);
  draw_math(ui, ImGui::GetWindowDrawList(), at, color, text);
}

void math_paragraph(const Ui& ui, ImU32 color, const std::string& text) {
  const std::string lines = wrapped(text, ImGui::GetContentRegionAvail().x);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(ImGui::GetStyle().ItemSpacing.x, 0));
  ImGui::BeginGroup();
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    math_text(ui, color, lines.substr(begin, end - begin));
    begin = end + 1;
  }
  ImGui::EndGroup();
  ImGui::PopStyleVar();
}

// ---- Numbers -----------------------------------------------------------------------------------

std::string number_text(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "–" : value > 0 ? "∞" : "-∞";
  if (value == std::floor(value) && std::abs(value) < 1e6) return fmt::format("{:.0f}", value);
  return fmt::format("{:.4g}", value);
}

std::string grouped(std::int64_t number) {
  const std::string digits = std::to_string(std::abs(number));
  std::string text = number < 0 ? "−" : "";
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ' ';
    text += digits[i];
  }
  return text;
}

// ---- Buttons -----------------------------------------------------------------------------------

bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled) {
  ImGui::BeginDisabled(!enabled);
  const bool clicked = ImGui::Button((text + "###" + widget).c_str());
  ImGui::EndDisabled();
  ui.name(widget);
  return clicked;
}

void action_button(const Ui& ui, const char* action, const char* label) {
  const Action& what = find_action(action);
  const bool enabled = what.can_run(ui.state), lit = what.is_on(ui.state);
  if (lit) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_Header]);
  ImGui::BeginDisabled(!enabled);
  ImGui::PushID(action);
  if (ImGui::Button(label)) ui.act(action);
  ImGui::PopID();
  ImGui::EndDisabled();
  if (lit) ImGui::PopStyleColor();
  ui.name(std::string("button.") + action);
  tooltip(what.keys.empty() ? what.title : what.title + "   " + what.keys);
}

void action_item(const Ui& ui, const Action& action, const std::string& prefix) {
  if (ImGui::MenuItem(action.title.c_str(), first_key(action).c_str(), action.is_on(ui.state),
                      action.can_run(ui.state)))
    ui.act(action.name);
  ui.name(prefix + "." + action.name);
}

void toolbar(const Ui& ui, const char* more, std::span<const ToolButton> buttons) {
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const float room = right - ImGui::GetItemRectMax().x, dots = gap + button_width("…");
  float all = 0;
  for (const ToolButton& button : buttons) all += gap + button_width(button.label);
  std::size_t shown = 0;
  for (float used = all > room ? dots : 0; shown < buttons.size(); ++shown) {
    used += gap + button_width(buttons[shown].label);
    if (used > room) break;
    ImGui::SameLine(0, gap);
    action_button(ui, buttons[shown].action, buttons[shown].label);
  }
  if (shown == buttons.size()) return;
  ImGui::SameLine(0, gap);
  if (ImGui::Button("…")) ImGui::OpenPopup(more);
  ui.name(more);
  tooltip("More");
  if (!ImGui::BeginPopup(more)) return;
  for (const ToolButton& button : buttons.subspan(shown))
    action_item(ui, find_action(button.action), "more");
  ImGui::EndPopup();
}

float button_width(const std::string& text) {
  return ImGui::CalcTextSize(text.c_str()).x + 2 * ImGui::GetStyle().FramePadding.x;
}

bool same_line_if_room(float width, float gap) {
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + gap + width > right) return false;
  ImGui::SameLine(0, gap);
  return true;
}

void same_line_if_fits(const std::string& text) {
  same_line_if_room(button_width(text), ImGui::GetStyle().ItemSpacing.x);
}

// ---- Tables and lists --------------------------------------------------------------------------

void fixed_column(const char* title, const char* widest, float more_px) {
  const float width = std::max(ImGui::CalcTextSize(title).x, ImGui::CalcTextSize(widest).x);
  ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed, width + more_px);
}

void cell(const std::string& text) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(text.c_str());
}

void scroll_to_row(int row, float row_height) {
  const float top = static_cast<float>(row) * row_height;
  const float height = ImGui::GetWindowHeight();
  if (top < ImGui::GetScrollY() || top + row_height > ImGui::GetScrollY() + height)
    ImGui::SetScrollY(std::max(0.0f, top - height * 0.4f));
}

// ---- Mouse -------------------------------------------------------------------------------------

bool was_dragged(int button) {
  constexpr float kClickSlack_px = 4;
  return ImGui::GetIO().MouseDragMaxDistanceSqr[button] > kClickSlack_px * kClickSlack_px;
}

}  // namespace planescope::desktop
