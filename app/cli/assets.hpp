#pragma once

#include <filesystem>
#include <string>

namespace planescope::app {

/// A file or folder that ships with us: in $PLANESCOPE_ASSETS where that is set, otherwise in
/// ../share/planescope beside the executable, otherwise in the source tree. Throws Error,
/// "WHAT missing: there is no PLACE nor PLACE", if it is in none of them.
std::filesystem::path find_asset(const std::string& name, const std::string& what);

}  // namespace planescope::app
