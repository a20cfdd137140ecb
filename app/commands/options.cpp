#include "app/commands/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace {

void print_json(const planes::PipelineOptions& options) {
  nlohmann::ordered_json json;
  json["schema"] = "planescope.options/1";
  json["options"] = nlohmann::ordered_json::array();
  for (const planes::OptionInfo& info : planes::option_table())
    json["options"].push_back({{"name", info.name},
                               {"value", info.get(options)},
                               {"unit", info.unit},
                               {"section", info.section},
                               {"meaning", info.meaning}});
  fmt::print("{}\n", json.dump(2));
}

void print_table(const planes::PipelineOptions& options) {
  std::size_t name_width = 0, value_width = 0;
  for (const planes::OptionInfo& info : planes::option_table()) {
    name_width = std::max(name_width, info.name.size());
    value_width = std::max(value_width, info.get(options).size());
  }
  fmt::print("Values of profile {}. Set one with --set NAME=VALUE.\n",
             planes::to_string(options.segment.profile));
  std::string section;
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (info.section != section) fmt::print("\n{}\n", info.section);
    section = info.section;
    fmt::print("  {:<{}}  {:>{}}  {} [{}]\n", info.name, name_width, info.get(options), value_width,
               info.meaning, info.unit);
  }
}

}  // namespace

int run_options(const OptionsArgs& args) {
  if (args.json)
    print_json(args.pipeline);
  else
    print_table(args.pipeline);
  return 0;
}

}  // namespace planescope::app
