#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_planes(const Ui&) {}

}  // namespace planescope::desktop
