#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_criteria(const Ui&) {}

}  // namespace planescope::desktop
