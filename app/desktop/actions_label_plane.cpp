#include "app/desktop/actions.hpp"

namespace planescope::desktop {

std::vector<Action> label_plane_actions() { return {}; }

}  // namespace planescope::desktop
