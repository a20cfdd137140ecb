#pragma once

#include <string>
#include <vector>

#include "app/desktop/ui.hpp"
#include "core/debug/explain/explain.hpp"

namespace planescope::desktop {

/// Criteria as `value  op  threshold  -> pass / fail  margin`, in the order asked. A click on a row
/// whose threshold is an option leads to its slider.
void draw_checks(const Ui& ui, const std::string& name, const std::vector<debug::Check>& checks);

}  // namespace planescope::desktop
