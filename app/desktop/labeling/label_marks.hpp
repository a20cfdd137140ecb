#pragma once

// Which frames of a recording have labels.

#include <filesystem>
#include <stop_token>
#include <vector>

#include "app/desktop/state/label_state.hpp"

namespace planescope::desktop {

/// From the label files. Long recordings have many: where it was stopped, there are fewer marks
/// than frames.
std::vector<FrameMark> marks_in(const std::filesystem::path& dir,
                                int frames,
                                const std::stop_token& stop);

}  // namespace planescope::desktop
