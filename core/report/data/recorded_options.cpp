#include "core/report/data/recorded_options.hpp"

#include <algorithm>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope {

PipelineOptions options_of(const RecordedReport& report, std::vector<std::string>& unknown) {
  PipelineOptions options;
  // The profile sets what the others then change.
  for (const auto& [name, value] : report.options)
    if (name == "profile") set_option(options, name, value);
  for (const auto& [name, value] : report.options) {
    if (name == "profile") continue;
    const bool known = std::ranges::any_of(
        option_table(), [&name = name](const OptionInfo& info) { return info.name == name; });
    if (known)
      set_option(options, name, value);
    else
      unknown.push_back(name);
  }
  return options;
}

}  // namespace planescope
