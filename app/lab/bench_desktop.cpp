// planescope-lab bench desktop: frame times of the window, rendered offscreen.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/view.hpp"
#include "app/desktop/window.hpp"
#include "app/lab/lab.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

using namespace desktop;
using Clock = std::chrono::steady_clock;

struct BenchDesktopArgs {
  ViewArgs view;              // recording, options, size of the window
  int steps = 500;            // of scrubbing
  std::string command;        // as typed
  std::filesystem::path out;  // -o; empty: stdout
};

constexpr int kTicks = 60;  // of a slider drag

struct Times {
  std::vector<double> ms;

  void add(Clock::time_point since) {
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - since).count());
  }
};

/// Times one frame until the GPU has finished it.
void time_frame(Offscreen& window, Times& times) {
  const auto start = Clock::now();
  window.draw_frame();
  window.finish();
  times.add(start);
}

/// Times a frame that must be redrawn completely.
void time_whole_frame(Offscreen& window, Times& times) {
  window.screen().forget();
  time_frame(window, times);
}

/// Measures how long the window takes to show a step, offscreen, compared with an empty window in
/// the same run.
int run_bench_desktop(const BenchDesktopArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const ViewArgs& view = args.view;
  const auto scale = static_cast<float>(view.scale);
  Offscreen window(view_state(view), view.width, view.height, scale);
  State unopened;
  Offscreen nothing(std::move(unopened), view.width, view.height, scale);
  settle(nothing.shell(), nothing, stop);
  settle(window.shell(), window, stop);
  if (!window.shell().state().run()) throw Error(window.shell().state().results.refusal);
  const std::shared_ptr<const debug::Run> run = window.shell().state().run_view()->run;
  window.shell().perform({"tab.tool", "histograms"});  // no searches in the background
  window.shell().perform({"strip.cancel", ""});
  settle(window.shell(), window, stop);

  Times scrub, jump, tick, empty;
  {
    Progress progress("bench desktop", 2 * args.steps + kTicks);
    const int steps = run->steps();
    const int first = std::max(0, steps / 2 - args.steps / 2);
    const auto go_to = [&](int i, const char* what, int step, Times& times) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(i, what);
      window.shell().perform({"step.goto", std::to_string(step)});
      time_frame(window, times);
      time_whole_frame(nothing, empty);
    };
    for (int i = 0; i < args.steps; ++i) go_to(i, "scrub", std::min(steps, first + i), scrub);
    for (int i = 0; i < args.steps; ++i) {
      const auto far = static_cast<std::int64_t>(i) * 7919 % (steps + 1);
      go_to(args.steps + i, "jump", static_cast<int>(far), jump);
    }
    const auto before = window.shell().state().document.options.segment.theta_n_out;
    for (int i = 0; i < kTicks; ++i) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(2 * args.steps + i, "slider");
      const auto shown = window.shell().state().results.current;
      const auto start = Clock::now();
      window.shell().perform({"option.drag", fmt::format("theta_n_out={}", before + 1 + (i % 2))});
      while (window.shell().state().results.current == shown) {
        // As on a display, the window idles while there is nothing new to draw.
        if (!window.shell().needs_frame())
          std::this_thread::sleep_for(std::chrono::microseconds(200));
        window.draw_frame();
      }
      window.finish();
      tick.add(start);
    }
  }

  lab::ResultLines lines(
      "desktop", args.command, {},
      {{"width", view.width}, {"height", view.height}, {"voxels", run->subject->voxel_count()}});
  for (const auto& [what, times] :
       {std::pair("empty window", &empty), std::pair("one step on", &scrub),
        std::pair("a step anywhere in the trace", &jump),
        std::pair("a tick of a slider, run and shown", &tick)})
    lines.add("times", {{"what", what}, {"ms", times->ms}});
  deliver(lines, args.out, "desktop");
  return 0;
}

}  // namespace

void define_bench_desktop(CLI::App* bench, Line& line) {
  CLI::App* command =
      bench->add_subcommand("desktop",
                            "Time the debugger's window\n"
                            "Draws a step, a slider tick, and an empty window without a display.");
  const auto args = std::make_shared<BenchDesktopArgs>();
  ViewArgs& view = args->view;
  add_recordings(command, view.input, false);
  add_out(command, args->out);
  add(command, "--steps", args->steps, "N", "Steps to scrub through (default 500)")
      ->transform(whole(1));
  add_size(command, view.width, view.height, "Window size in pixels (default 1440x900)", 640, 400);
  add_method(command, view.input.pipeline);
  command->remove_option(command->get_option("--method"));
  runs(command, line, args, run_bench_desktop, [args, &line] {
    args->command = line.text;
    expect_ours(args->view.input.pipeline, "bench desktop");
    args->view.fresh = true;
  });
}

}  // namespace planescope::app
