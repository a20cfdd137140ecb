#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_timeline(const Ui&) {}

}  // namespace planescope::desktop
