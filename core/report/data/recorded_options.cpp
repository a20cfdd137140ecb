#include "core/report/data/recorded_options.hpp"

#include <algorithm>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope::report {

planes::PipelineOptions options_of(const RecordedReport& report,
                                   std::vector<std::string>& unknown) {
  planes::PipelineOptions options;
  // The profile sets what the others then change.
  for (const auto& [name, value] : report.options)
    if (name == "profile") planes::set_option(options, name, value);
  for (const auto& [name, value] : report.options) {
    if (name == "profile") continue;
    const bool known = std::ranges::any_of(
        planes::option_table(),
        [&name = name](const planes::OptionInfo& info) { return info.name == name; });
    if (known)
      planes::set_option(options, name, value);
    else
      unknown.push_back(name);
  }
  return options;
}

}  // namespace planescope::report
