#pragma once

#include <string>

#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

/// "merge_cost 10 → 7: planes 17 → 20 (+4 −1)": what a change of options did to a frame's planes.
/// Empty where it is another frame, or no option of the segmentation changed.
std::string change_text(const debug::Run& before, const debug::Run& after);

}  // namespace planescope::desktop
