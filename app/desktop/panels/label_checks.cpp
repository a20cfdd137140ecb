#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_checks(const Ui&) {}

}  // namespace planescope::desktop
