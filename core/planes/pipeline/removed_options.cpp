#include "core/planes/pipeline/removed_options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace planescope::planes {

std::span<const RemovedOption> removed_options() { return {}; }

std::string removed_text(std::string_view kind,
                         std::string_view name,
                         std::span<const RemovedOption> removed) {
  const auto row = std::ranges::find(removed, name, &RemovedOption::name);
  if (row == removed.end()) return "";
  return fmt::format("{} {} was removed in {}{}{}", kind, name, row->version,
                     row->see.empty() ? "" : "; see ", row->see);
}

}  // namespace planescope::planes
