#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_label_review(const Ui&) {}

}  // namespace planescope::desktop
