#pragma once

// Changes that would make a surface what it should be, and the answer to a click.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// A row each, with what it gains and moves elsewhere. `check`: with a button for what it does to
/// the labeled frames.
void draw_fix_table(const Ui& ui, const FixSearch& fix, bool check);
void draw_fix_progress(const Ui& ui, const FixSearch& fix);

/// What a click searches for the selected point. False: it asks for nothing, nothing is drawn.
bool draw_try(const Ui& ui);
/// Why the selected point is in no plane, or not in the one it should be: the decisions, and what
/// would change them. Draws nothing where neither is asked.
void draw_answer(const Ui& ui);

}  // namespace planescope::desktop
