// planescope-lab: measures planescope and generates its evaluation and training sets.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/cli/output.hpp"
#include "app/cli/program.hpp"
#include "app/commands/train.hpp"
#include "app/lab/lab.hpp"
#include "core/io/open3d/install.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

void define_bench(CLI::App& app, Line& line) {
  CLI::App* bench = app.add_subcommand("bench", "Measure accuracy and speed");
  for (const auto define : {define_bench_paper, define_bench_real, define_bench_steady,
                            define_bench_outlines, define_bench_map, define_bench_stairs,
                            define_bench_classifier, define_bench_desktop, define_bench_speed})
    define(bench, line);
}

}  // namespace

void add_parts(CLI::App* command,
               std::set<std::string>& parts,
               const std::vector<std::string>& known,
               const std::string& help) {
  add(command, "--only", parts, "PART,...", help)->check(some_of(known, "a part"));
}

std::string typed_text(const CLI::App& command, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    if (const CLI::Option* option = command.get_option(name); option->count() > 0)
      text += fmt::format(" {} {}", name, CLI::detail::join(option->results(), ","));
  return text;
}

std::filesystem::path data_folder() {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data || !*data) return {};
  if (!std::filesystem::is_directory(data))
    throw Error(std::string("PLANESCOPE_DATA: ") + data + " is not a folder");
  return data;
}

std::vector<int> spread(std::span<const int> frames, int most) {
  const std::size_t used = std::min(frames.size(), static_cast<std::size_t>(most));
  std::vector<int> spread;
  for (std::size_t i = 0; i < used; ++i) spread.push_back(frames[i * frames.size() / used]);
  return spread;
}

void deliver(const lab::ResultLines& lines,
             const std::filesystem::path& dir,
             const std::string& name) {
  if (dir.empty()) {
    fmt::print("{}", lines.text());
    return;
  }
  make_output_dir(dir);
  const std::filesystem::path file = dir / (name + ".jsonl");
  write_file_text(file, lines.text());
  fmt::print("{}: {} lines; scripts/typeset prints them as tables\n", file.string(),
             std::ranges::count(lines.text(), '\n'));
}

}  // namespace planescope::app

int main(int argc, char** argv) {
  planescope::open3d::install();
  using namespace planescope::app;
  const Program program = {
      .name = "planescope-lab",
      .about =
          "planescope-lab measures the accuracy and speed of planescope and of other methods, and "
          "writes synthetic data for measuring and training.",
      .commands = {define_bench, define_synth_sets, define_recipe_train, define_help, define_man,
                   define_completions}};
  return run_program(program, argc, argv);
}
