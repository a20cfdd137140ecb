#pragma once

// The parts of the state that are saved as JSON: sessions and window settings.

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

// A session restores the view on another machine: recording by path and hash, options, cursor,
// camera, filter, breakpoints and bookmarks. Schema planescope.session/2.

/// Throws Error if the file cannot be written; an existing file is then unchanged.
void save_session(const State& state, const std::filesystem::path& path);

/// `where` is a file, or file#bookmark. The recording is opened from the session's path or beside
/// the session file. On failure, throws Error with the file and the problem and leaves the state
/// unchanged: damaged JSON, a missing or different recording, an unknown option.
void open_session(State& state, const std::string& where);

/// Shows a frame of a reopened recording in place of its previous version. Drops earlier results.
void take_recording(State& state, OpenRecording taken, int frame);

/// Options for opening recordings in the window, which asks for missing intrinsics.
io::RecordingOptions options_to_open(io::RecordingOptions options);

/// All view settings kept in sessions and window settings, by key.
nlohmann::ordered_json view_json(const ViewState& view);

// ---- Settings ----------------------------------------------------------------------------------

/// Window settings that persist between runs.
struct Settings {
  int width = 1440, height = 900;  // of the window [px]
  bool maximized = false;
  std::filesystem::path last_recording;  // empty: none yet
  int last_frame = 0;
  std::vector<std::filesystem::path> recent;  // as in Document
  std::optional<render::Camera> camera;       // for that recording
  ViewState view;                             // panels, colors, theme, layout
};

/// $XDG_STATE_HOME/planescope/desktop.json; ~/.local/state if it is not set.
std::filesystem::path settings_path();

/// Missing, damaged or incompatible settings are ignored, so that the window always opens.
Settings load_settings();
/// Does nothing if the folder is not writable.
void save_settings(const Settings& settings);

// Opens a location in a report: the recording, the options of both runs, the plane, and the step at
// which the window starts.

/// Whether `where`, up to '#', is a report. False for unreadable files.
bool is_report(const std::string& where);

struct ReportLink {
  std::string target;                              // see report_target.hpp
  std::filesystem::path baseline;                  // empty: the one named in the report
  std::optional<std::filesystem::path> label_dir;  // nullopt: beside the recording
  bool only_given = false;                         // use only open recordings
};

/// Sets the options of the report for run B and those of its baseline for run A. The recording is
/// looked up among the open ones, at its typed path, beside the report, and relative to the
/// report's folder and its parents: the first whose frame has the same SHA-256 is used. A damaged
/// frame does not prevent showing the others. On failure, throws Error with the file and the
/// problem and leaves the state unchanged: a location that is not in the report, or a different
/// recording or weights.
void open_report(State& state, const ReportLink& link);

/// A location in a report, with the report's data about it.
struct ReportPlace {
  int frame = 0;
  int plane = 0;             // 0: only the frame
  bool of_baseline = false;  // whether the plane is the baseline's
  report::ReportFrame now;
  std::optional<report::ReportFrame> baseline;  // if it has the same input
  std::optional<report::PlaneComparison> fate;  // of the plane since the baseline
  std::optional<planes::PipelineOptions> options_a;
  std::string note;  // differences from the report, one line
};

struct RunArrival {
  std::int32_t step = -1;  // -1: the last
  std::int32_t plane = -1, voxel = -1;
  bool in_a = false;                  // everything refers to run A
  std::vector<std::uint32_t> marked;  // voxels of the lost plane
  std::string message;
};

/// Finds the decision that created or lost the plane. `a` may be null.
RunArrival arrival_at(const ReportPlace& place, const debug::Run* a, const debug::Run& b);

}  // namespace planescope::desktop
