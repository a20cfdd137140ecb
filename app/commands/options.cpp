#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands/commands.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace {

struct OptionsArgs {
  planes::PipelineOptions pipeline;  // the values to show
  bool json = false;
};

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

/// Prints every option that --set takes, with its unit, value and meaning. Returns the exit code.
int run_options(const OptionsArgs& args, std::stop_token) {
  if (args.json)
    print_json(args.pipeline);
  else
    print_table(args.pipeline);
  return 0;
}

}  // namespace

void define_options(CLI::App& app, Line& line) {
  CLI::App* options = app.add_subcommand(
      "options", "List every option that --set takes, with value, unit and meaning");
  const auto args = std::make_shared<OptionsArgs>();
  add_json(options, args->json);
  add_method(options, args->pipeline);
  runs(options, line, args, run_options);
}

}  // namespace planescope::app
