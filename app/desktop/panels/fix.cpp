#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_fix(const Ui&) {}

}  // namespace planescope::desktop
