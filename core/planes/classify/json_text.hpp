#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace planescope::planes {

/// JSON of an origin that is not trusted. Throws Error that begins with `what` where it is not
/// valid, nested too deep, or names a key twice.
nlohmann::json parse_json(std::string_view text, const std::string& what);

/// `text` as it may stand in a message: quoted, control characters escaped, cut where it is long.
std::string shown(const std::string& text);

}  // namespace planescope::planes
