#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_status(const Ui&) {}

}  // namespace planescope::desktop
