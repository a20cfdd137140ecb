#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_events(const Ui&) {}

}  // namespace planescope::desktop
