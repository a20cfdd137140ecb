#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_menu(const Ui&) {}

}  // namespace planescope::desktop
