#pragma once

// A box for a filter: what is wrong with it underlined, completions under the cursor.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

struct FilterBox {
  std::string widget;                   // its name
  std::string hint;                     // shown while it is empty
  std::string text;                     // as the state has it
  const debug::FilterProblem* problem;  // with that; null or without a message: none
  std::string action;                   // takes the text, at every key
  std::string on_enter;                 // action; empty: none
};
void draw_filter_box(const Ui& ui, const FilterBox& box, float width);

}  // namespace planescope::desktop
