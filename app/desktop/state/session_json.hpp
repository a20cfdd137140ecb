#pragma once

// Parts of session and settings files. Readers throw nlohmann's exceptions, or Error.

#include <exception>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// What one of nlohmann's exceptions says, without its own name and number.
std::string json_problem(const std::exception& problem);

nlohmann::ordered_json bookmark_json(const Bookmark& bookmark);
Bookmark bookmark_of(const nlohmann::ordered_json& json);
nlohmann::ordered_json breakpoint_json(const Breakpoint& breakpoint);
Breakpoint breakpoint_of(const nlohmann::ordered_json& json);

/// Panels, colours, theme, layout: what is not the cursor.
nlohmann::ordered_json view_json(const ViewState& view);
/// Keys that are missing leave what `view` has.
void view_of(const nlohmann::ordered_json& json, ViewState& view);

}  // namespace planescope::desktop
