#pragma once

// A command consists of a struct of its own options, bound to CLI11's, and a job. The options that
// many commands share are added here.

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

/// A command line while it is read.
struct Line {
  std::string text;         // as one could type it again in a shell
  std::string frames_text;  // without what changes no frame of a report: where it is written, how
                            // it is run, what it is held to
  Job job;                  // of the command that was typed
};

/// `command`, where it was typed, runs run(*args): its options are bound to `args`. `finish`, where
/// given, is called before, when all options have their values; it may throw Error.
template <typename Args>
void runs(CLI::App* command,
          Line& line,
          const std::shared_ptr<Args>& args,
          std::type_identity_t<std::function<int(const Args&, std::stop_token)>> run,
          std::function<void()> finish = {}) {
  command->final_callback([=, &line] {
    if (!command->get_subcommands().empty()) return;  // one of its own commands was typed
    if (finish) finish();
    line.job = [args, run](std::stop_token stop) { return run(*args, std::move(stop)); };
  });
}

/// An option with a value; the values of a list are one word, separated by commas, and what follows
/// is no more of them.
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
/// An option whose text is read by `read`, which may throw Error. Options are read in the order in
/// which they were added, whatever the order in which they were typed.
CLI::Option* add_read(CLI::App* command,
                      const std::string& names,
                      const std::function<void(const std::string&)>& read,
                      const std::string& type,
                      const std::string& help);

// Of values: whole() writes the number plainly and goes into transform(), the others into check().
CLI::Validator whole(int least, int most = INT_MAX);
CLI::Validator number(double least, double most = std::numeric_limits<double>::infinity());
CLI::Validator some_of(const std::vector<std::string>& known, const std::string& what);

// Which recordings, and how their frames become planes.
void add_inputs(CLI::App* command, InputArgs& args, const std::string& what);
/// Inputs of every format, or the sample recording: one, or `many`.
void add_recordings(CLI::App* command, InputArgs& args, bool many, bool clouds = true);
/// One of the options that set_pipeline_option() knows by its name.
CLI::Option* add_of_method(CLI::App* command,
                           planes::PipelineOptions& options,
                           const char* name,
                           const std::string& type,
                           const std::string& help);
/// What becomes of a frame before its points are labelled.
void add_clouds(CLI::App* command, planes::PipelineOptions& options);
void add_method(CLI::App* command, planes::PipelineOptions& options);
/// --foot.
void add_foot(CLI::App* command, planes::PipelineOptions& options);
CLI::Option* add_threads(CLI::App* command, int& threads);

void add_json(CLI::App* command, bool& json);
CLI::Option* add_out(CLI::App* command, std::filesystem::path& out);
/// -o for commands that write a folder or a PlanesFile.
CLI::Option* add_planes_out(CLI::App* command, std::filesystem::path& out);
inline constexpr const char* kPlanesOut = "DIR|FILE.mcap";
inline constexpr const char* kPlanesOutHelp =
    "Output folder, or one file of all frames and planes for Foxglove, RViz and ros2 bag";
void add_size(CLI::App* command,
              int& width,
              int& height,
              const std::string& help,
              int least_width = 1,
              int least_height = 1);

/// Throws Error for other methods: commands that measure our own steps have nothing to measure
/// there.
void expect_ours(const planes::PipelineOptions& options, const char* command);
/// Throws Error without gravity: commands about h and v need it.
void expect_gravity(const planes::PipelineOptions& options, const char* command);

}  // namespace planescope::app
