#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_histograms(const Ui&) {}

}  // namespace planescope::desktop
