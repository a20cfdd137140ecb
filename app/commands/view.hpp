#pragma once

// Options of planescope view, and the desktop state they open.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "app/commands/inputs.hpp"
#include "app/desktop/state/state.hpp"

namespace planescope::app {

struct ViewArgs {
  InputArgs input;
  std::string open;                  // session or report, or a place in it after a '#'
  std::filesystem::path baseline;    // of the report; empty: the one that it names
  std::string compare;               // a profile, as B against what is typed
  std::filesystem::path script;      // scripted actions and input
  std::filesystem::path screenshot;  // a PNG of the window, drawn without a display
  std::filesystem::path state;       // facts about the window, as JSON
  bool list_actions = false;
  bool offscreen = false;          // no window, even where there is a display
  int width = 1440, height = 900;  // of the picture [px]
  double scale = 1;                // of text and lines in it
  bool fresh = false;              // ignore what the window remembers
};

/// The desktop's state with what was asked for open: recordings, a session, or the sample.
desktop::State view_state(const ViewArgs& args);

}  // namespace planescope::app
