#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_compare(const Ui&) {}

}  // namespace planescope::desktop
