#pragma once

// What of the state is kept in files, as JSON: sessions, and what the window remembers.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/compare/compare_reports.hpp"
#include "core/report/data/report_data.hpp"

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

// From a report's line to the window: the recording, the options of both runs, the plane, and where
// in a run the window begins.

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

/// A place in a report, with what is known of it there.
struct ReportPlace {
  int frame = 0;
  int plane = 0;             // 0: the frame alone
  bool of_baseline = false;  // whose plane it is
  report::ReportFrame now;
  std::optional<report::ReportFrame> baseline;  // where it has the same input
  std::optional<report::PlaneComparison> fate;  // of the plane since the baseline
  std::optional<planes::PipelineOptions> options_a;
  std::string note;  // what is not as it was, one line
};

struct RunArrival {
  std::int32_t step = -1;  // -1: the last
  std::int32_t plane = -1, voxel = -1;
  bool in_a = false;                  // all of this is of run A
  std::vector<std::uint32_t> marked;  // voxels of the plane that is no more
  std::string message;
};

/// The decision that made the plane what it is, or that lost it. `a` null: there is no such run.
RunArrival arrival_at(const ReportPlace& place, const debug::Run* a, const debug::Run& b);

}  // namespace planescope::desktop
