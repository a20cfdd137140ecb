#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_frames(const Ui&) {}

}  // namespace planescope::desktop
