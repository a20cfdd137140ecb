#pragma once

// All commands of planescope. Each is defined in a file named after it.

#include "app/cli/command.hpp"

namespace planescope::app {

void define_view(CLI::App& app, Line& line);
void define_info(CLI::App& app, Line& line);
void define_segment(CLI::App& app, Line& line);
void define_report(CLI::App& app, Line& line);
void define_eval(CLI::App& app, Line& line);
void define_options(CLI::App& app, Line& line);
void define_synth(CLI::App& app, Line& line);
void define_train(CLI::App& app, Line& line);
void define_tune(CLI::App& app, Line& line);
void define_labels(CLI::App& app, Line& line);
void define_convert(CLI::App& app, Line& line);
void define_map(CLI::App& app, Line& line);

}  // namespace planescope::app
