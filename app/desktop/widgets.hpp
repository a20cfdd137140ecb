#pragma once

// Small things that several panels are made of.

#include <string>

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

inline constexpr ImGuiTableFlags kTable =
    ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_PadOuterX;

/// Since the left button went down the mouse has moved, by more than in a click.
bool was_dragged();
/// Text in the accent colour that can be clicked; true where it was. Wraps.
bool link(const Ui& ui, const std::string& text, const std::string& widget);
/// A title in the bold font.
void heading(const Ui& ui, const std::string& text);
/// Text in a colour, wrapped between words.
void paragraph(ImU32 color, const std::string& text);
/// The same with symbols set as in math_text.hpp.
void math_paragraph(const Ui& ui, ImU32 color, const std::string& text);
/// A button that is greyed and does nothing where it cannot be used; true where it was clicked.
bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled = true);
/// Puts a button with this text beside the last item where that leaves room, below it otherwise.
void same_line_if_fits(const std::string& text);
/// "Ctrl+Shift+Z / Ctrl+Y": all keys of an action.
std::string keys_text(const Action& action);

}  // namespace planescope::desktop
