#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_palette(const Ui&) {}

}  // namespace planescope::desktop
