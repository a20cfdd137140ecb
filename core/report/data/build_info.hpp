#pragma once

#include <string>

namespace planescope::report {

/// What this binary was built from.
struct BuildInfo {
  std::string version;    // "0.2.0"
  std::string commit;     // 40 hex digits, or "unknown" where it was not built from a git checkout
  bool modified = false;  // tracked files differed from the commit
};
BuildInfo build_info();

}  // namespace planescope::report
