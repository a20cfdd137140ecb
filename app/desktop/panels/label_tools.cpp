#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_tools(const Ui&) {}

}  // namespace planescope::desktop
