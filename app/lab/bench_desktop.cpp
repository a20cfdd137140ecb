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
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

using namespace desktop;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct BenchDesktopArgs {
  ViewArgs view;              // recording, options, size of the window
  int steps = 500;            // of the scrub
  std::filesystem::path out;  // desktop.json is written there; empty: nowhere
  bool json = false;
};

constexpr int kTicks = 60;  // of a slider

struct Times {
  std::vector<double> ms;

  void add(Clock::time_point since) {
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - since).count());
  }
  double at(double share) const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
};

/// One frame, drawn to the end.
void time_frame(Offscreen& window, Times& times) {
  const auto start = Clock::now();
  window.draw_frame();
  window.finish();
  times.add(start);
}

Json to_json(const Times& times, const Times& empty) {
  return {{"median_ms", times.at(0.5)},
          {"p99_ms", times.at(0.99)},
          {"median_ratio", times.at(0.5) / empty.at(0.5)},
          {"p99_ratio", times.at(0.99) / empty.at(0.99)}};
}

void print_row(const char* what, const Times& times, const Times& empty) {
  fmt::print("{:<34} {:>8.1f} ms {:>8.1f} ms {:>8.2f} x {:>8.2f} x\n", what, times.at(0.5),
             times.at(0.99), times.at(0.5) / empty.at(0.5), times.at(0.99) / empty.at(0.99));
}

/// The same as if nothing of it stood there yet.
void time_whole_frame(Offscreen& window, Times& times) {
  window.screen().forget();
  time_frame(window, times);
}

/// How long the window takes to show a step, off-screen, against an empty one in the same run.
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
        // As on a display, the window rests while there is nothing new to show.
        if (!window.shell().needs_frame())
          std::this_thread::sleep_for(std::chrono::microseconds(200));
        window.draw_frame();
      }
      window.finish();
      tick.add(start);
    }
  }

  if (!args.out.empty() || args.json) {
    Json json = {{"schema", "planescope.bench.desktop/1"},
                 {"width", view.width},
                 {"height", view.height},
                 {"voxels", run->subject->voxel_count()},
                 {"steps", args.steps},
                 {"empty", to_json(empty, empty)},
                 {"scrub", to_json(scrub, empty)},
                 {"jump", to_json(jump, empty)},
                 {"slider", to_json(tick, empty)}};
    const std::string text = json.dump(2) + '\n';
    if (args.json) fmt::print("{}", text);
    if (!args.out.empty()) {
      make_output_dir(args.out);
      write_file_text(args.out / "desktop.json", text);
    }
  }
  if (args.json) return 0;
  fmt::print("{} x {}, {} voxels; ratios are to an empty window of the same size\n\n", view.width,
             view.height, run->subject->voxel_count());
  fmt::print("{:<34} {:>11} {:>11} {:>10} {:>10}\n", "", "median", "99 %", "median", "99 %");
  print_row("empty window", empty, empty);
  print_row("one step on", scrub, empty);
  print_row("a step anywhere in the trace", jump, empty);
  print_row("a tick of a slider, run and shown", tick, empty);
  return 0;
}

}  // namespace

void define_bench_desktop(CLI::App* bench, Line& line) {
  CLI::App* command = bench->add_subcommand(
      "desktop",
      "How long the debugger's window takes to show a step and a slider's tick, drawn without a\n"
      "display, against an empty window in the same run.");
  const auto args = std::make_shared<BenchDesktopArgs>();
  ViewArgs& view = args->view;
  add_inputs(command, view.input, io::recordings_text(false));
  add_out(command, args->out);
  add_json(command, args->json);
  add(command, "--steps", args->steps, "N", "Steps of the scrub, default 500")->transform(whole(1));
  add_size(command, view.width, view.height, "Of the window in pixels, default 1440x900", 640, 400);
  add_method(command, view.input.pipeline);
  command->remove_option(command->get_option("--method"));
  runs(command, line, args, run_bench_desktop, [args] {
    expect_ours(args->view.input.pipeline, "bench desktop");
    args->view.fresh = true;
  });
}

}  // namespace planescope::app
