#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_octree(const Ui&) {}

}  // namespace planescope::desktop
