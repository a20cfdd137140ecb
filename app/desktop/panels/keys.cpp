#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_keys(const Ui&) {}

}  // namespace planescope::desktop
