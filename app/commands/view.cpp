#include "app/commands/view.hpp"

#include <fmt/format.h>

#include <optional>

#include "app/cli/assets.hpp"
#include "app/desktop/state/report_open.hpp"
#include "app/desktop/state/session.hpp"
#include "app/desktop/state/state.hpp"
#include "app/desktop/window.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using namespace desktop;

void print_actions() {
  for (const Action& action : action_table())
    fmt::print("{:<22} {:<16} {}{}\n", action.name, action.keys, action.title,
               action.takes.empty() ? "" : " (" + action.takes + ")");
}

/// Opens what was asked for: recordings, a session, a report, what was open last, or the sample.
State first_state(const ViewArgs& args, const Settings& settings) {
  State state;
  Document& document = state.document;
  state.view = settings.view;
  state.view.message = "? shows the keys, Ctrl+P finds an action by name";
  document.options = args.input.pipeline;
  document.recording_options = args.input.recording;
  const bool opens_report = !args.open.empty() && is_report(args.open);
  io::RecordingOptions options = args.input.recording;
  options.damaged_frames_later = opens_report;  // it may be another frame that is opened
  const auto open = [&](const fs::path& path) {
    document.recordings.push_back({path, io::open_recording(path, options),
                                   args.input.label_dir.value_or(labels::default_label_dir(path))});
    read_picked(state, document.recordings.back());
  };
  for (const fs::path& path : args.input.inputs) open(path);
  if (document.recordings.empty() && args.open.empty() && !settings.last_recording.empty()) {
    try {
      open(settings.last_recording);
      document.frame = settings.last_frame;
      state.view.camera = settings.camera;
    } catch (const Error&) {
      // What was open last is gone or damaged: nobody asked for it, so the sample is shown.
    }
  }
  if (document.recordings.empty() && args.open.empty())
    open(find_asset("sample", "no recording was given, and the sample is"));
  if (!document.recordings.empty()) {
    document.recording = 0;
    const int count = document.current()->recording->frame_count();
    const std::vector<int> frames = sliced_frames(args.input.frames, count);
    if (frames.empty())
      throw Error(fmt::format("{}: --frames leaves none of its {} frames",
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
    throw Error(args.open + ": is no report, so --baseline says nothing of it");
  return state;
}

/// Nothing is worked out for a file that cannot be written.
void expect_folder_of(const std::filesystem::path& file) {
  if (file.empty()) return;
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw Error(
        fmt::format("{}: cannot be written, {} is no folder", file.string(), folder.string()));
}

int run_offscreen(const ViewArgs& args, std::stop_token stop) {
  expect_folder_of(args.screenshot);
  expect_folder_of(args.state);
  std::optional<Script> script;
  if (!args.script.empty()) script = Script::read(args.script);
  std::unique_ptr<Offscreen> offscreen;
  State state = view_state(args);
  try {
    offscreen = std::make_unique<Offscreen>(std::move(state), args.width, args.height,
                                            static_cast<float>(args.scale));
  } catch (const Error& error) {
    fmt::print(stderr, "planescope: the window cannot be drawn: {}\n", error.what());
    return 3;
  }
  settle(offscreen->shell(), *offscreen, stop, /*background=*/false);
  if (script) script->play(offscreen->shell(), *offscreen, stop);
  if (!args.screenshot.empty() || !args.state.empty()) settle(offscreen->shell(), *offscreen, stop);
  if (!args.screenshot.empty()) offscreen->screenshot(args.screenshot);
  if (!args.state.empty())
    write_file_text(args.state, state_text(offscreen->shell().state(), true));
  return 0;
}

int run_on_display(const ViewArgs& args, std::stop_token stop) {
  WindowOptions options;
  options.settings = args.fresh ? Settings{} : load_settings();
  options.keep_settings = !args.fresh;
  options.state_file = args.state;
  if (!args.script.empty()) options.script = Script::read(args.script);
  try {
    run_window(first_state(args, options.settings), options, stop);
  } catch (const NoDisplay& none) {
    fmt::print(stderr,
               "planescope: {}; without a display, `planescope report` and `planescope segment` "
               "work, and `planescope view --screenshot FILE.png`, or --offscreen with a script, "
               "draws this "
               "window\n",
               none.what());
    return 3;
  }
  return 0;
}

}  // namespace

State view_state(const ViewArgs& args) { return first_state(args, {}); }

int run_view(const ViewArgs& args, std::stop_token stop) {
  if (args.list_actions) {
    print_actions();
    return 0;
  }
  try {
    const bool offscreen = args.offscreen || !args.screenshot.empty();
    return offscreen ? run_offscreen(args, stop) : run_on_display(args, stop);
  } catch (const ExpectationFailed& failed) {
    fmt::print(stderr, "planescope: {}\n", failed.what());
    return 1;
  }
}

}  // namespace planescope::app
