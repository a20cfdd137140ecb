#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_image(const Ui&) {}

}  // namespace planescope::desktop
