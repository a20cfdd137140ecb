#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_view3d(const Ui&) {}

}  // namespace planescope::desktop
