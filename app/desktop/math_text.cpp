#include "app/desktop/math_text.hpp"

#include <imgui_internal.h>

#include <cctype>
#include <cmath>

namespace planescope::desktop {
namespace {

constexpr float kSubscriptSize = 0.78f;  // of the text's
constexpr float kSubscriptDrop = 0.34f;  // of the text's height

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// Does the underscore follow a symbol, one letter on its own? Not so in names of options.
bool is_subscript(const std::string& text, std::size_t mark) {
  if (mark == 0 || mark + 1 == text.size() || !is_word(text[mark + 1])) return false;
  std::size_t letter = mark - 1;
  while (letter > 0 && (text[letter] & 0xc0) == 0x80) --letter;  // the first byte of UTF-8
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
  // Not ImGui::CalcTextSize(), which rounds up: parts would stand apart.
  const ImFont& font = sub ? *ui.small : *ImGui::GetFont();
  const float size = ImGui::GetFontSize() * (sub ? kSubscriptSize : 1);
  const char* data = text.data();
  return font.CalcTextSizeA(size, 1e6f, 0, data + begin, data + end).x;
}

}  // namespace

float math_width(const Ui& ui, const std::string& text) {
  float width = 0;
  for_parts(text, [&](std::size_t begin, std::size_t end, bool sub) {
    width += width_of(ui, text, begin, end, sub);
  });
  return width;
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
  // As text does, beside a button or a box.
  at.y += ImGui::GetCurrentWindowRead()->DC.CurrLineTextBaseOffset;
  ImGui::Dummy(size);
  draw_math(ui, ImGui::GetWindowDrawList(), at, color, text);
}

}  // namespace planescope::desktop
