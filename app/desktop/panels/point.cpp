#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_point(const Ui&) {}

}  // namespace planescope::desktop
