#pragma once

// A command is a struct of options, bound to CLI11, and a job that runs with them. Options shared
// by several commands are added here.

#include <CLI/CLI.hpp>
#include <climits>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <type_traits>
#include <vector>

#include "app/commands/inputs.hpp"

namespace planescope::app {

/// A command with its options, ready to run; returns the exit code.
using Job = std::function<int(std::stop_token)>;

/// A command line while it is being parsed.
struct Line {
  std::string text;         // quoted, ready to paste into a shell
  std::string frames_text;  // without the options that do not affect a report's frames: output,
                            // threads, baseline, rules
  Job job;                  // the selected command
};

/// Binds `command` to run(*args) with the options in `args`. If set, `finish` is called first, once
/// all options have their values; it may throw Error.
template <typename Args>
void runs(CLI::App* command,
          Line& line,
          const std::shared_ptr<Args>& args,
          std::type_identity_t<std::function<int(const Args&, std::stop_token)>> run,
          std::function<void()> finish = {}) {
  command->final_callback([=, &line] {
    if (!command->get_subcommands().empty()) return;  // one of its subcommands was selected
    if (finish) finish();
    line.job = [args, run](std::stop_token stop) { return run(*args, std::move(stop)); };
  });
}

/// Adds an option with a value. The values of a list are one comma-separated word; the words after
/// it are not part of the list.
template <typename Value>
CLI::Option* add(CLI::App* command,
                 const std::string& names,
                 Value& value,
                 const std::string& type,
                 const std::string& help) {
  CLI::Option* option = command->add_option(names, value, help)->type_name(type);
  if constexpr (CLI::detail::is_mutable_container<Value>::value &&
                !std::is_same_v<Value, std::string>)
    option->delimiter(',')->expected(1)->allow_extra_args(false)->multi_option_policy(
        CLI::MultiOptionPolicy::TakeAll);
  return option;
}
/// Adds an option whose text is parsed by `read`, which may throw Error. Options are parsed in the
/// order in which they were added, regardless of their order on the command line.
CLI::Option* add_read(CLI::App* command,
                      const std::string& names,
                      const std::function<void(const std::string&)>& read,
                      const std::string& type,
                      const std::string& help);

// Validators. whole() normalizes the number, so pass it to transform(); pass the others to check().
CLI::Validator whole(int least, int most = INT_MAX);
CLI::Validator number(double least, double most = std::numeric_limits<double>::infinity());
CLI::Validator some_of(const std::vector<std::string>& known, const std::string& what);

// Recording and method options.
void add_inputs(CLI::App* command, InputArgs& args, const std::string& what);
/// Accepts inputs of every format, one or `many`; the default is the sample recording.
void add_recordings(CLI::App* command, InputArgs& args, bool many, bool clouds = true);
/// Adds one of the options supported by set_pipeline_option().
CLI::Option* add_of_method(CLI::App* command,
                           planes::PipelineOptions& options,
                           const char* name,
                           const std::string& type,
                           const std::string& help);
/// Adds the options for preprocessing a frame.
void add_clouds(CLI::App* command, planes::PipelineOptions& options);
void add_method(CLI::App* command, planes::PipelineOptions& options);
/// Adds --foot.
void add_foot(CLI::App* command, planes::PipelineOptions& options);
CLI::Option* add_threads(CLI::App* command, int& threads);

void add_json(CLI::App* command, bool& json);
CLI::Option* add_out(CLI::App* command, std::filesystem::path& out);
/// The first clause of a help text, for use within a sentence: "Output folder; ..." gives "output
/// folder". Acronyms stay in capitals.
std::string clause_of(const std::string& help);

/// -o for commands that write a folder or a PlanesFile.
CLI::Option* add_planes_out(CLI::App* command, std::filesystem::path& out);
inline constexpr const char* kPlanesOut = "DIR|FILE.mcap";
inline constexpr const char* kPlanesOutHelp =
    "Output folder, or one file of all frames and planes for Foxglove, RViz, and ros2 bag";
void add_size(CLI::App* command,
              int& width,
              int& height,
              const std::string& help,
              int least_width = 1,
              int least_height = 1);

/// Throws Error for other methods: commands that measure the steps of our method do not support
/// them.
void expect_ours(const planes::PipelineOptions& options, const char* command);
/// Throws Error without gravity, which commands about h and v labels need.
void expect_gravity(const planes::PipelineOptions& options, const char* command);

}  // namespace planescope::app
