#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "app/cli/cli_parts.hpp"
#include "app/lab/bench_real.hpp"

namespace planescope::app {

void define_bench_real(CLI::App& bench, Typed& t, std::function<void(Job)> choose) {
  CLI::App* real = bench.add_subcommand(
      "real",
      "Every method by pixel: on labelled frames of real recordings, on depth sets of many seeds,\n"
      "and from frame to frame of a recording. Writes real.json and real.md.");
  add(real, "--frames-list", t.frames_list, "FILE",
      "Lines of NAME HALF RECORDING FRAME OPTIONS: the labelled frames, with --intrinsics, "
      "--depth-unit, --gravity and --max-range as they need them");
  add(real, "--data", t.data, "DIR", "Folder of the recordings; default $PLANESCOPE_DATA");
  add(real, "--labels", t.labels, "DIR",
      "Where the folder NAME holds the labels of each frame that is listed");
  add_out(real, t);
  add_json(real, t);
  add(real, "--only", t.only, "PART,...",
      fmt::format("Of {}; default: all", fmt::join(bench_real_parts(), ", ")));
  add(real, "--half", t.half, "tuning|printed", "Listed frames of this half alone; default: both");
  add(real, "--seeds", t.seeds, "N,...", "Of the depth sets, default 1,2,3,4,5,6,1001,2001");
  add(real, "--count", t.count, "N",
      "At most so many frames of each set, and of the recording that is followed; default all");
  add(real, "--threads", t.threads, "N",
      "Default: all cores. The results are the same for any number");
  real->final_callback([&t, choose] {
    choose(
        [args = bench_real_args(t)](std::stop_token stop) { return run_bench_real(args, stop); });
  });
}

}  // namespace planescope::app
