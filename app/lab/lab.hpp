#pragma once

// Commands of planescope-lab, which measures planescope and generates its training sets, and their
// shared helpers.

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

/// Adds --only PART,... with the given parts; the default is all of them.
void add_parts(CLI::App* command,
               std::set<std::string>& parts,
               const std::vector<std::string>& known,
               const std::string& help);

/// Returns the given options as typed, e.g. " --count 3 --seed 7".
std::string typed_text(const CLI::App& command, const std::vector<std::string>& names);

/// Returns $PLANESCOPE_DATA, or an empty path if it is not set. Throws Error if it is not a folder.
std::filesystem::path data_folder();

/// Selects at most `most` of the frames, evenly spaced.
std::vector<int> spread(std::span<const int> frames, int most);

/// Writes DIR/NAME.jsonl and prints its path, or prints the lines if `dir` is empty.
void deliver(const lab::ResultLines& lines,
             const std::filesystem::path& dir,
             const std::string& name);

/// Counts the heap allocations of `work` on the calling thread: malloc and everything based on it,
/// including operator new. Growing a block counts as a new allocation. Empty in builds that cannot
/// count: with sanitizers, which replace malloc themselves, and with C libraries other than glibc.
lab::CountAllocations allocation_counter();

}  // namespace planescope::app
