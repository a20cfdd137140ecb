#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "app/cli/cli_parts.hpp"
#include "app/lab/bench_paper.hpp"

namespace planescope::app {

void define_bench_paper(CLI::App& bench, Typed& t, std::function<void(Job)> choose) {
  CLI::App* paper = bench.add_subcommand(
      "paper",
      "Every experiment of the paper beside its printed numbers, and measures on which methods\n"
      "really differ: tables, plots and pictures as one page.");
  add_inputs(paper, t,
             "Recordings for table IV; without, those of assets/paper_recordings.txt that are\n"
             "below $PLANESCOPE_DATA");
  paper->remove_option(paper->get_option("--labels"));
  add(paper, "--gravity", t.gravity, "auto|X,Y,Z|imu|estimate", "Of the recordings that are given")
      ->group("Recordings");
  add_out(paper, t);
  add_json(paper, t);
  paper->add_flag("--quick", t.quick, "Fewer frames and conditions: under two minutes");
  paper->add_flag("--resume", t.resume, "Go on with the run that was cut short in DIR");
  add(paper, "--only", t.only, "PART,...",
      fmt::format("Of {}; the others stay as they are in DIR. Default: all",
                  fmt::join(bench_paper_parts(), ", ")));
  add(paper, "--seed", t.seed, "N", "Of the sets that the tables are printed for, default 1");
  add(paper, "--tuning-seed", t.tuning_seed, "N",
      "Of the sets that options were tuned on, shown beside the claims; default 1001");
  add(paper, "--sets", t.sets, "NAME,...",
      "Measure these alone, of stairs, kerbs, depth_boxes, ...");
  add(paper, "--count", t.count, "N", "At most so many frames of each set; default all");
  paper
      ->add_option("--weights", t.weights,
                   wrapped("The network: gcn, the one that comes with planescope (default), or a "
                           "file"))
      ->type_name("gcn|FILE")
      ->allow_extra_args(false);
  add(paper, "--from", t.from, "DIR",
      "Measure nothing: write pages of the results there, with figures where\nthey are of this "
      "commit");
  add(paper, "--doc", t.doc, "FILE.md", "With --from: write docs/reproduction.md alone");
  add(paper, "--threads", t.threads, "N",
      "Default: all cores. The results are the same for any number");
  paper->final_callback([&t, choose] {
    choose(
        [args = bench_paper_args(t)](std::stop_token stop) { return run_bench_paper(args, stop); });
  });
}

}  // namespace planescope::app
