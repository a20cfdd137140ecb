#pragma once

// Every command of planescope-lab, which measures planescope and makes what it is trained with.

#include <set>

#include "app/commands/commands.hpp"

namespace planescope::app {

void define_bench_paper(CLI::App* bench, Line& line);
void define_bench_real(CLI::App* bench, Line& line);
void define_bench_outlines(CLI::App* bench, Line& line);
void define_bench_map(CLI::App* bench, Line& line);
void define_bench_classifier(CLI::App* bench, Line& line);
void define_bench_desktop(CLI::App* bench, Line& line);
void define_bench_speed(CLI::App* bench, Line& line);
void define_bench_stairs(CLI::App* bench, Line& line);
void define_bench_steady(CLI::App* bench, Line& line);
void define_synth_sets(CLI::App& app, Line& line);

/// --only PART,... of the parts there are; none is all of them.
void add_parts(CLI::App* command,
               std::set<std::string>& parts,
               const std::vector<std::string>& known,
               const std::string& help);

/// These options as they were typed, " --count 3 --seed 7".
std::string typed_text(const CLI::App& command, const std::vector<std::string>& names);

/// $PLANESCOPE_DATA, empty where it is not set. Throws Error where it is no folder.
std::filesystem::path data_folder();

}  // namespace planescope::app
