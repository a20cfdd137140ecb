#include "app/desktop/actions.hpp"

namespace planescope::desktop {

std::vector<Action> label_tool_actions() { return {}; }

}  // namespace planescope::desktop
