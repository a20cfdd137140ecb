#pragma once

// What the commands' definitions share: options that many of them have, and messages.

#include <functional>
#include <string>
#include <vector>

#include "app/cli/cli.hpp"
#include "app/cli/typed.hpp"

namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI

namespace planescope::app {

/// CLI11 prints descriptions as they are: broken here, so that they fit beside the names.
std::string wrapped(const std::string& text);

CLI::Option* add(CLI::App* command,
                 const std::string& names,
                 std::string& value,
                 const std::string& type,
                 const std::string& help);
void add_inputs(CLI::App* command, Typed& t, const std::string& what);
/// What becomes of a frame before its points are labelled.
void add_clouds(CLI::App* command, Typed& t);
void add_method(CLI::App* command, Typed& t);
void add_json(CLI::App* command, Typed& t);
void add_out(CLI::App* command, Typed& t);

/// The command that was typed last: `synth stairs` is the app of `stairs`.
const CLI::App* innermost(const CLI::App* app);
std::vector<std::string> subcommand_names(const CLI::App* app);
/// One line for what CLI11 did not understand, with the name that was probably meant.
std::string message_of(const CLI::App& app, const CLI::ParseError& error);

/// planescope bench paper and real, synth ... and labels ...; `choose` is given the job that was
/// typed.
void define_bench_paper(CLI::App& bench, Typed& t, std::function<void(Job)> choose);
void define_bench_real(CLI::App& bench, Typed& t, std::function<void(Job)> choose);
void define_synth(CLI::App& app, Typed& typed, const std::function<void(Job)>& choose);
void define_labels(CLI::App& app, Typed& typed, std::function<void(Job)> choose);

}  // namespace planescope::app
