#pragma once

// Every command of planescope-lab, which measures planescope and makes what it is trained with; and
// what these commands share.

#include <set>
#include <span>

#include "app/commands/commands.hpp"
#include "core/lab/bench/chain_speed.hpp"
#include "core/lab/bench/result_lines.hpp"

namespace planescope::app {

using planescope::json_of;

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

/// At most so many of them, evenly spread.
std::vector<int> spread(std::span<const int> frames, int most);

/// Writes DIR/NAME.jsonl and says so, or prints the lines where no folder is given.
void deliver(const lab::ResultLines& lines,
             const std::filesystem::path& dir,
             const std::string& name);

/// What `work` allocates on the calling thread: malloc and all that ends there, operator new too.
/// Growing a block counts as a new one. Empty where this build cannot count: under sanitizers,
/// which stand there themselves, and with other C libraries than glibc.
lab::CountAllocations allocation_counter();

}  // namespace planescope::app
