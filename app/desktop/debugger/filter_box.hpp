#pragma once

// A box for a filter: what is wrong with it underlined, completions under the cursor.

#include <string>

#include "core/debug/filter/filter.hpp"

namespace planescope::desktop {

struct Ui;

struct FilterBox {
  std::string widget;                   // its name
  std::string hint;                     // shown while it is empty
  std::string text;                     // as the state has it
  const debug::FilterProblem* problem;  // with that; null or without a message: none
  std::string action;                   // takes the text, at every key
  std::string on_enter;                 // action; empty: none
};
void draw_filter_box(const Ui& ui, const FilterBox& box, float width);

/// A filter being typed, from frame to frame.
struct FilterBoxMemory {
  std::string text;     // follows the state until it is edited
  std::string applied;  // what of the state it follows
  int cursor = 0;
  int place_cursor = -1;  // where to put it once the box has the keyboard again
  int chosen = 0;         // of the completions
  bool take_keyboard = false, popup_hovered = false;
};

}  // namespace planescope::desktop
