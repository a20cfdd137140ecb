#pragma once

// Options of planescope view and the desktop state that they select.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "app/commands/inputs.hpp"
#include "app/desktop/state/state.hpp"

namespace planescope::app {

struct ViewArgs {
  InputArgs input;
  std::string open;                  // session or report, optionally with a location after '#'
  std::filesystem::path baseline;    // the report's baseline; empty: the one named in it
  std::string compare;               // a profile to show as B beside the given options
  std::filesystem::path script;      // actions and input to replay
  std::filesystem::path screenshot;  // PNG of the window, rendered offscreen
  std::filesystem::path state;       // facts about the window, as JSON
  bool list_actions = false;
  bool offscreen = false;          // no window, even with a display
  int width = 1440, height = 900;  // screenshot size [px]
  double scale = 1;                // of text and lines
  bool fresh = false;              // ignore saved window settings
};

/// Returns the desktop state with the requested recordings, session or sample open.
desktop::State view_state(const ViewArgs& args);

}  // namespace planescope::app
