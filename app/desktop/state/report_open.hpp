#pragma once

// From a report's line to the window: the recording, the options of both runs, and the plane.

#include <filesystem>
#include <optional>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// Whether `where`, without what follows '#', is a report. False for what cannot be read.
bool is_report(const std::string& where);

struct ReportLink {
  std::string target;                              // report_target.hpp
  std::filesystem::path baseline;                  // empty: the one that the report names
  std::optional<std::filesystem::path> label_dir;  // nothing: beside the recording
  bool only_given = false;                         // the recording is one of those that are open
};

/// Options of the report become those of run B, of its baseline those of run A. The recording is
/// looked for among those open, as it was typed, beside the report, and from its folder and those
/// above on: the first whose frame has the same SHA-256. A damaged frame does not keep the
/// others from being shown. Throws Error that names the file and what is wrong, the state
/// unchanged: a place that the report does not have, a recording or weights that are others.
void open_report(State& state, const ReportLink& link);

}  // namespace planescope::desktop
