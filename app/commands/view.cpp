// planescope view: opens the desktop window, on a display or offscreen.

#include "app/commands/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "app/cli/output.hpp"
#include "app/commands/commands.hpp"
#include "app/desktop/state/session.hpp"
#include "app/desktop/state/state.hpp"
#include "app/desktop/window.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using namespace desktop;

void print_actions() {
  for (const Action& action : action_table())
    fmt::print("{:<22} {:<16} {}{}\n", action.name, action.keys, action.title,
               action.takes.empty() ? "" : " (" + action.takes + ")");
}

/// Opens the requested recordings, session or report, otherwise the last document or the sample.
State first_state(const ViewArgs& args, const Settings& settings) {
  State state;
  Document& document = state.document;
  state.view = settings.view;
  say_hint(state, "? shows the keys, Ctrl+P finds an action by name",
           [](const State& s) { return s.view.show_keys || s.view.show_palette; });
  document.options = args.input.pipeline;
  document.recording_options = args.input.recording;
  const bool opens_report = !args.open.empty() && is_report(args.open);
  const io::RecordingOptions options = options_to_open(args.input.recording);
  const auto open = [&](const fs::path& path) {
    for (const fs::path& out : {args.screenshot, args.state}) check_outside(out, path);
    document.recordings.push_back({path, io::open_recording(path, options),
                                   args.input.label_dir.value_or(labels::default_label_dir(path))});
    read_picked(state, document.recordings.back());
  };
  document.recent = settings.recent;
  for (const fs::path& path : args.input.inputs) open(path);
  for (std::size_t i = args.input.inputs.size(); i-- > 0;)  // show the first one
    note_recent(document, args.input.inputs[i]);
  if (document.recordings.empty() && args.open.empty() && !settings.last_recording.empty()) {
    try {
      open(settings.last_recording);
      document.frame = settings.last_frame;
      state.view.camera = settings.camera;
    } catch (const Error&) {
      // The last document is missing or damaged: show the sample, since the user did not ask for
      // it.
    }
  }
  if (document.recordings.empty() && args.open.empty())
    open(find_asset("sample", "no recording was specified, and the sample is"));
  if (!document.recordings.empty()) {
    document.recording = 0;
    const int count = document.current()->recording->frame_count();
    const std::vector<int> frames = sliced_frames(args.input.frames, count);
    if (frames.empty())
      throw Error(fmt::format("{}: --frames selects none of its {} frames (numbered from 0)",
                              document.current()->path.string(), count));
    document.frame = document.frame > 0 && document.frame < count ? document.frame : frames[0];
  }
  if (args.open.empty()) return state;
  if (opens_report)
    open_report(state,
                {args.open, args.baseline, args.input.label_dir, !args.input.inputs.empty()});
  else if (args.baseline.empty())
    open_session(state, args.open);
  else
    throw Error(args.open + ": not a report.json, so it cannot have a baseline; remove --baseline");
  return state;
}

/// Throws Error before any work if the file cannot be written.
void expect_folder_of(const std::filesystem::path& file) {
  if (file.empty()) return;
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw Error(
        fmt::format("{}: cannot be written: {} is not a folder", file.string(), folder.string()));
}

/// Prints which frames of the opened recordings are damaged. Returns the exit code.
int report_damaged(const State& state) {
  int code = 0;
  for (const OpenRecording& open : state.document.recordings) {
    const std::vector<int> all = sliced_frames({}, open.recording->frame_count());
    code = std::max(code, damaged_at_open(*open.recording, all).report(all.size()));
  }
  return code;
}

/// Scripts to run once the window is open.
std::vector<Script> scripts_of(const ViewArgs& args) {
  std::vector<Script> scripts;
  if (!args.compare.empty())
    scripts.push_back(Script::of("compare.profile", args.compare, "--compare"));
  if (!args.script.empty()) scripts.push_back(Script::read(args.script));
  return scripts;
}

int run_offscreen(const ViewArgs& args, std::stop_token stop) {
  expect_folder_of(args.screenshot);
  expect_folder_of(args.state);
  const std::vector<Script> scripts = scripts_of(args);
  std::unique_ptr<Offscreen> offscreen;
  State state = view_state(args);
  const int code = report_damaged(state);
  try {
    offscreen = std::make_unique<Offscreen>(std::move(state), args.width, args.height,
                                            static_cast<float>(args.scale));
  } catch (const Error& error) {
    notice("cannot draw the window: {}", error.what());
    return 3;
  }
  settle(offscreen->shell(), *offscreen, stop, /*background=*/false);
  for (const Script& script : scripts) script.play(offscreen->shell(), *offscreen, stop);
  if (!args.screenshot.empty() || !args.state.empty()) settle(offscreen->shell(), *offscreen, stop);
  if (!args.screenshot.empty()) offscreen->screenshot(args.screenshot);
  if (!args.state.empty())
    write_file_text(args.state, state_text(offscreen->shell().state(), true));
  return code;
}

int run_on_display(const ViewArgs& args, std::stop_token stop) {
  WindowOptions options;
  options.settings = args.fresh ? Settings{} : load_settings();
  options.keep_settings = !args.fresh;
  options.state_file = args.state;
  options.scripts = scripts_of(args);
  if (!options.scripts.empty())  // scripts step by event, regardless of the user's last setting
    options.settings.view.step_unit = debug::StepUnit::event;
  int code = 0;
  try {
    State state = first_state(args, options.settings);
    code = report_damaged(state);
    run_window(std::move(state), options, stop);
  } catch (const NoDisplay& none) {
    notice(
        "{}; without a display, use `planescope report` or `planescope segment`, or draw this "
        "window off-screen with `planescope view --screenshot FILE.png`, or with --offscreen and a "
        "script",
        none.what());
    return 3;
  }
  return code;
}

/// Opens the desktop or, with --screenshot, --script or --offscreen, its offscreen counterpart.
/// Exit code 1: a script expectation failed; 3: no display or no GL.
int run_view(const ViewArgs& args, std::stop_token stop) {
  if (args.list_actions) {
    print_actions();
    return 0;
  }
  try {
    const bool offscreen = args.offscreen || !args.screenshot.empty();
    return offscreen ? run_offscreen(args, stop) : run_on_display(args, stop);
  } catch (const ExpectationFailed& failed) {
    notice("{}", failed.what());
    return 1;
  }
}

/// Whether method options were typed; sessions and reports bring their own.
bool method_typed(const CLI::App& view) {
  return std::ranges::any_of(view.get_options(), [](const CLI::Option* option) {
    return option->get_group() == "Method" && option->get_name() != "--threads" &&
           option->count() > 0;
  });
}

}  // namespace

State view_state(const ViewArgs& args) { return first_state(args, {}); }

void define_view(CLI::App& app, Line& line) {
  CLI::App* view = app.add_subcommand(
      "view",
      "Open the debugger; Ctrl+L opens the label editor\n"
      "Step through the octree traversal and find out why a plane was found, merged, or lost. "
      "Without a display, --screenshot renders the same window to a picture.");
  const auto args = std::make_shared<ViewArgs>();
  add_recordings(view, args->input, true);
  view->get_option("--frames")->description("Frame to open first; the strip shows all frames");
  view->get_option("--frames")->type_name("N");
  add_method(view, args->input.pipeline);
  add_foot(view, args->input.pipeline);
  const std::string window = "Window";
  const auto option = [&](const char* name, auto& value, const char* type, const char* help) {
    return add(view, name, value, type, help)->group(window);
  };
  option("--open", args->open, "FILE[#PLACE]",
         "Open a saved session at a bookmark, or a report.json at a decision: f12/p3 for the one "
         "that created plane 3 of frame 12, f12/was3 for the one that lost plane 3 of the "
         "baseline. Start with r2/ for the second recording of the report");
  option("--baseline", args->baseline, "FILE",
         "Baseline of the opened report, whose options become run A (default: the one that the "
         "report names)");
  option("--compare", args->compare, "NAME|FILE",
         "Profile to compare with: it becomes run B, the current options run A");
  option("--script", args->script, "FILE.json",
         "Script of actions and input to run first (docs/desktop.md)");
  option("--screenshot", args->screenshot, "FILE.png", "Render the window to a picture and exit");
  option("--state", args->state, "FILE.json", "Write the state of the window as JSON");
  add_size(view, args->width, args->height, "Picture size in pixels (default 1440x900)", 640, 400);
  view->get_option("--size")->group(window);
  option("--scale", args->scale, "FACTOR", "Scale of text and lines in the picture (default 1)")
      ->check(number(0.5, 4));
  view->add_flag("--offscreen", args->offscreen, "Open no window, even if there is a display")
      ->group(window);
  view->add_flag("--fresh", args->fresh, "Ignore saved window settings and save none")
      ->group(window);
  view->add_flag("--actions", args->list_actions, "List all actions with their keys")
      ->group(window);
  runs(view, line, args, run_view, [view, args] {
    // Accept a session or report as the only argument, e.g. from a file manager.
    std::vector<fs::path>& inputs = args->input.inputs;
    if (args->open.empty() && inputs.size() == 1 && inputs[0].extension() == ".json") {
      args->open = inputs[0].string();
      inputs.clear();
    }
    if (!args->screenshot.empty() && args->screenshot.extension() != ".png")
      throw Error("--screenshot " + args->screenshot.string() +
                  ": not a PNG file; expected a name that ends in .png");
    planes::PipelineOptions ignored;
    if (!args->compare.empty()) planes::set_profile(ignored, args->compare);  // throws if invalid
    if (args->open.empty() && !args->baseline.empty())
      throw Error("--baseline needs --open REPORT.json");
    if (!args->open.empty() && method_typed(*view))
      throw Error(
          "--open uses the options of the session or report; remove --profile, --set, and other "
          "method options");
  });
}

}  // namespace planescope::app
