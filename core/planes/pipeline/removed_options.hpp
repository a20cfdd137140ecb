#pragma once

// Options and profiles that earlier versions had.

#include <span>
#include <string>
#include <string_view>

namespace planescope::planes {

struct RemovedOption {
  std::string_view name;             // of an option, or of a profile
  std::string_view see;              // the option or profile that replaces it; empty: none does
  std::string_view version = "0.2";  // the first without it
};

/// Every one of them. A name that is removed gets a row here.
std::span<const RemovedOption> removed_options();

/// "option r1_max_angle_deg was removed in 0.2; see merge". Empty: there never was such a name.
/// `kind`: "option" or "profile".
std::string removed_text(std::string_view kind,
                         std::string_view name,
                         std::span<const RemovedOption> removed = removed_options());

}  // namespace planescope::planes
