#pragma once

// The window on a display.

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <stop_token>

#include "app/desktop/script.hpp"
#include "app/desktop/state/settings.hpp"

namespace planescope::desktop {

/// No window can be opened here.
struct NoDisplay : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  Settings settings;                 // size and place
  bool keep_settings = true;         // write them back when it closes
  std::optional<Script> script;      // played when the window is there
  std::filesystem::path state_file;  // state_facts() whenever they change; empty: nowhere
};

/// Shows the window until it is closed. Throws NoDisplay.
void run_window(State state, const WindowOptions& options, std::stop_token stop);

}  // namespace planescope::desktop
