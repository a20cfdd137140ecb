// The planescope executable.

#include "app/cli/program.hpp"
#include "app/commands/commands.hpp"
#include "core/io/open3d/install.hpp"

int main(int argc, char** argv) {
  planescope::open3d::install();
  using namespace planescope::app;
  const Program program = {
      .name = "planescope",
      .about =
          "planescope finds planes in depth recordings and point clouds, after Sun et al. 2023, "
          "\"Multi-Resolution Planar Region Extraction for Uneven Terrains\".",
      .commands = {define_view, define_info, define_segment, define_report, define_eval,
                   define_options, define_synth, define_train, define_tune, define_labels,
                   define_convert, define_map, define_help, define_man, define_completions},
      .alone = "view"};
  return run_program(program, argc, argv);
}
