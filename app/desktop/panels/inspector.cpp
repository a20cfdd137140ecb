#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_inspector(const Ui&) {}

}  // namespace planescope::desktop
