#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_space(const Ui&) {}

}  // namespace planescope::desktop
