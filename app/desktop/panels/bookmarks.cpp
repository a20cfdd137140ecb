#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_bookmarks(const Ui&) {}

}  // namespace planescope::desktop
