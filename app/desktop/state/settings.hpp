#pragma once

// What the window remembers from one time to the next, in
// $XDG_STATE_HOME/planescope/desktop.json (~/.local/state where that is not set).

#include <filesystem>
#include <optional>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

struct Settings {
  int width = 1440, height = 900;  // of the window [px]
  bool maximized = false;
  std::filesystem::path last_recording;  // empty: none yet
  int last_frame = 0;
  std::optional<render::Camera> camera;  // on that recording
  ViewState view;                        // panels, colours, theme, layout
};

std::filesystem::path settings_path();

/// Settings that are missing, damaged or of another version are ignored: a window opens in any
/// case.
Settings load_settings();
/// Does nothing where the folder cannot be written to.
void save_settings(const Settings& settings);

}  // namespace planescope::desktop
