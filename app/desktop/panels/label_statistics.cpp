#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_statistics(const Ui&) {}

}  // namespace planescope::desktop
