#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_image(const Ui&) {}

}  // namespace planescope::desktop
