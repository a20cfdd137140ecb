#pragma once

// Building blocks of panels: text, numbers, buttons, tables and lists.

#include <algorithm>
#include <span>
#include <string>

#include "app/desktop/ui.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {

// ---- Colors ------------------------------------------------------------------------------------

ImU32 to_imgui(render::Rgba color);
/// `alpha` is from 0 to 255.
ImU32 with_alpha(ImU32 color, int alpha);
/// Black or white, whichever has more contrast with the fill.
ImU32 text_on(render::Rgba fill);
/// Color of a number that improved, got worse, or stayed the same.
ImU32 gain_color(const Ui& ui, int gain);

// ---- Text --------------------------------------------------------------------------------------

/// One colored line.
void colored(ImU32 color, const std::string& text);
/// Colored text, wrapped between words.
void paragraph(ImU32 color, const std::string& text);
/// A title in the bold font.
void heading(const Ui& ui, const std::string& text);
/// A name with its value beside it; wraps.
void fact(const Ui& ui, const char* what, const std::string& value);
/// Clickable text in the accent color; returns true if clicked. Wraps.
bool link(const Ui& ui, const std::string& text, const std::string& widget);
/// Shows the text beside, never over, the last drawn item while the mouse is over it.
void tooltip(const std::string& text);
/// Shows the text beside the mouse, without covering the item under it.
void tooltip_at_mouse(const std::string& text);
/// A short message in the middle of the remaining room.
void draw_notice(const Ui& ui, const std::string& text, ImU32 color);
/// A small filled square with the numeral of the case, at the cursor; advances like text.
void case_badge(const Ui& ui, planes::Case c);

// Math symbols as in the paper: text after an underscore is a smaller subscript, "N_out = 12" and
// "θ_Nout".

float math_width(const Ui& ui, const std::string& text);
/// Shortens text with an ellipsis if it is wider than `room` [px].
std::string fitted(const Ui& ui, const std::string& text, float room);
/// Draws at a window position.
void draw_math(const Ui& ui, ImDrawList* draw, ImVec2 at, ImU32 color, const std::string& text);
/// Draws at the cursor; advances like text.
void math_text(const Ui& ui, ImU32 color, const std::string& text);
/// Wrapped between words.
void math_paragraph(const Ui& ui, ImU32 color, const std::string& text);

// ---- Numbers -----------------------------------------------------------------------------------

/// "12", "0.0071", "∞"; "–" for NaN.
std::string number_text(double value);
/// "31 900": groups digits by threes.
std::string grouped(std::int64_t number);

// ---- Buttons -----------------------------------------------------------------------------------

/// A button, grayed out if disabled; returns true if clicked.
bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled = true);
/// A button that performs an action, highlighted while the action is on; its tooltip shows the
/// action's title and key. Named "button.<action>".
void action_button(const Ui& ui, const char* action, const char* label);
struct ToolButton {
  const char* action;
  const char* label;
};
/// Draws buttons beside the last item. Those without room go into a menu behind "…", which is named
/// `more`.
void toolbar(const Ui& ui, const char* more, std::span<const ToolButton> buttons);
/// An action with its key, as an item of the open menu. Named "`prefix`.<action>".
void action_item(const Ui& ui, const Action& action, const std::string& prefix);
/// Width of a button with this text.
float button_width(const std::string& text);
/// Stays on the line if the next item has room beside the last one; returns false otherwise.
bool same_line_if_room(float width, float gap);
/// Places a button with this text beside the last item if there is room, otherwise below it.
void same_line_if_fits(const std::string& text);

// ---- Tables and lists --------------------------------------------------------------------------

inline constexpr ImGuiTableFlags kTable =
    ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_PadOuterX;

/// A column as wide as its title and `widest`. ImGui's own widths take a few frames to settle.
void fixed_column(const char* title, const char* widest, float more_px = 0);
/// Draws the next cell of the row.
void cell(const std::string& text);
/// Scrolls a list with rows of equal height if the row is not visible.
void scroll_to_row(int row, float row_height);

/// Draws a list and the items below it. The list fills the room above them, based on their height
/// in the last frame, which is stored under `key`.
template <typename List, typename Below>
void list_above(const Ui& ui, const std::string& key, const List& list, const Below& below) {
  double& height = ui.memory.numbers[key];
  const float room = ImGui::GetContentRegionAvail().y - static_cast<float>(height);
  list(std::max(room, ui.px(90)));
  const float from = ImGui::GetCursorPosY();
  below();
  height = ImGui::GetCursorPosY() - from + ImGui::GetStyle().ItemSpacing.y;
}

// ---- Mouse -------------------------------------------------------------------------------------

/// Whether the mouse has moved farther than for a click since the button was pressed.
bool was_dragged(int button = 0);

}  // namespace planescope::desktop
