#pragma once

// What panels are made of: text, numbers, buttons, tables and lists.

#include <algorithm>
#include <span>
#include <string>

#include "app/desktop/ui.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {

// ---- Colours -----------------------------------------------------------------------------------

ImU32 to_imgui(render::Rgba color);
/// `alpha` from 0 to 255.
ImU32 with_alpha(ImU32 color, int alpha);
/// Black or white, whichever reads better on a fill.
ImU32 text_on(render::Rgba fill);
/// The colour of a number that has become better, become worse, or stayed the same.
ImU32 gain_color(const Ui& ui, int gain);

// ---- Text --------------------------------------------------------------------------------------

/// One line in a colour.
void colored(ImU32 color, const std::string& text);
/// Text in a colour, wrapped between words.
void paragraph(ImU32 color, const std::string& text);
/// A title in the bold font.
void heading(const Ui& ui, const std::string& text);
/// What something is called and, beside it, what it is; wraps.
void fact(const Ui& ui, const char* what, const std::string& value);
/// Text in the accent colour that can be clicked; true where it was. Wraps.
bool link(const Ui& ui, const std::string& text, const std::string& widget);
/// Shows the text beside the item drawn last while the mouse is over it, never on it.
void tooltip(const std::string& text);
/// Shows the text beside the mouse, where it leaves free what is pointed at.
void tooltip_at_mouse(const std::string& text);
/// A few words in the middle of the room that is left.
void draw_notice(const Ui& ui, const std::string& text, ImU32 color);
/// A small filled square with the case's numeral in it, at the cursor; advances like text.
void case_badge(const Ui& ui, planes::Case c);

// The paper's symbols as it prints them: what follows an underscore stands lower and smaller,
// "N_out = 12" and "θ_Nout".

float math_width(const Ui& ui, const std::string& text);
/// Shortened with an ellipsis where it is wider than there is room [px].
std::string fitted(const Ui& ui, const std::string& text, float room);
/// At a place of the window.
void draw_math(const Ui& ui, ImDrawList* draw, ImVec2 at, ImU32 color, const std::string& text);
/// At the cursor; advances like text.
void math_text(const Ui& ui, ImU32 color, const std::string& text);
/// Wrapped between words.
void math_paragraph(const Ui& ui, ImU32 color, const std::string& text);

// ---- Numbers -----------------------------------------------------------------------------------

/// "12", "0.0071", "∞"; "–" where there is none.
std::string number_text(double value);
/// "31 900": groups of three digits.
std::string grouped(std::int64_t number);

// ---- Buttons -----------------------------------------------------------------------------------

/// A button that is greyed and does nothing where it cannot be used; true where it was clicked.
bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled = true);
/// A button that performs an action, lit while the action is switched on; its tooltip tells the
/// action's title and key. Named "button.<action>".
void action_button(const Ui& ui, const char* action, const char* label);
struct ToolButton {
  const char* action;
  const char* label;
};
/// Buttons beside the last item; those that have no room there stand in a menu behind "…", which is
/// named `more`.
void toolbar(const Ui& ui, const char* more, std::span<const ToolButton> buttons);
/// An action in a menu that is open, with its key. Named "`prefix`.<action>".
void action_item(const Ui& ui, const Action& action, const std::string& prefix);
/// Of a button with this text.
float button_width(const std::string& text);
/// Stays on the line where the next item has room beside the last one; false where it has not.
bool same_line_if_room(float width, float gap);
/// Puts a button with this text beside the last item where that leaves room, below it otherwise.
void same_line_if_fits(const std::string& text);

// ---- Tables and lists --------------------------------------------------------------------------

inline constexpr ImGuiTableFlags kTable =
    ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_PadOuterX;

/// A column as wide as its title and `widest`. ImGui's own measurement of widths is right only a
/// few frames late.
void fixed_column(const char* title, const char* widest, float more_px = 0);
/// The next cell of the row.
void cell(const std::string& text);
/// Scrolls to a row of a list of equal rows where it is out of sight.
void scroll_to_row(int row, float row_height);

/// Draws a list and what stands below it. The list gets the height that the latter leaves, as high
/// as it was in the last frame. `key`: where that is remembered.
template <typename List, typename Below>
void list_above(const Ui& ui, const std::string& key, const List& list, const Below& below) {
  double& height = ui.memory.numbers[key];
  const float room = ImGui::GetContentRegionAvail().y - static_cast<float>(height);
  list(std::max(room, ui.px(90)));
  const float from = ImGui::GetCursorPosY();
  below();
  height = ImGui::GetCursorPosY() - from + ImGui::GetStyle().ItemSpacing.y;
}

// ---- The mouse ---------------------------------------------------------------------------------

/// Whether the mouse has moved by more than in a click since the button went down.
bool was_dragged(int button = 0);

}  // namespace planescope::desktop
