#pragma once

// What of the state is kept in files, as JSON: sessions, and what the window remembers.

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

// ---- Sessions ----------------------------------------------------------------------------------

// A session brings the view back on another machine. Recording by path and hash, options, cursor,
// camera, filter, breakpoints, bookmarks. Schema planescope.session/2.

/// Throws Error where the file cannot be written; a file that was there stays as it was then.
void save_session(const State& state, const std::filesystem::path& path);

/// `where`: a file, or file#bookmark. The recording is looked for where the session says, and
/// beside the session file. Throws Error that names the file and what is wrong with it, the state
/// unchanged: damaged JSON, a recording that is missing or is another one, an unknown option.
void open_session(State& state, const std::string& where);

/// Shows the frame of a recording that was reopened, in place of what was open of it. Earlier
/// results are dropped.
void take_recording(State& state, OpenRecording taken, int frame);

/// How the window opens recordings: it asks for intrinsics that one lacks.
io::RecordingOptions options_to_open(io::RecordingOptions options);

/// Every setting of the view that sessions and the window's memory keep, by key.
nlohmann::ordered_json view_json(const ViewState& view);

// ---- Settings ----------------------------------------------------------------------------------

/// What the window remembers from one time to the next.
struct Settings {
  int width = 1440, height = 900;  // of the window [px]
  bool maximized = false;
  std::filesystem::path last_recording;  // empty: none yet
  int last_frame = 0;
  std::vector<std::filesystem::path> recent;  // as the document's
  std::optional<render::Camera> camera;       // on that recording
  ViewState view;                             // panels, colours, theme, layout
};

/// $XDG_STATE_HOME/planescope/desktop.json; ~/.local/state where that is not set.
std::filesystem::path settings_path();

/// Settings that are missing, damaged or of another version are ignored: a window opens in any
/// case.
Settings load_settings();
/// Does nothing where the folder cannot be written to.
void save_settings(const Settings& settings);

}  // namespace planescope::desktop
