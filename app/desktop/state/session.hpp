#pragma once

// Session files: JSON that brings the view back on another machine. Recording by path and hash,
// options, cursor, camera, filter, breakpoints, bookmarks. Schema planescope.session/1.

#include <filesystem>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// Throws Error where the file cannot be written; a file that was there stays as it was then.
void save_session(const State& state, const std::filesystem::path& path);

/// `where`: a file, or file#bookmark. The recording is looked for where the session says, and
/// beside the session file. Throws Error that names the file and what is wrong with it, the state
/// unchanged: damaged JSON, a recording that is missing or is another one, an unknown option.
void open_session(State& state, const std::string& where);

/// Shows the frame of a recording that was reopened, in place of what was open of it. Earlier
/// results are dropped.
void take_recording(State& state, OpenRecording taken, int frame);

}  // namespace planescope::desktop
