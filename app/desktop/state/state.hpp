#pragma once

// The desktop as plain data: the document being worked on, immutable results of jobs, and the view.
// Panels read the state; only apply() in actions.hpp and jobs that deliver results change it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/desktop/state/label_state.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/fix.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/debug/explain/measure.hpp"
#include "core/debug/explain/score.hpp"
#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"
#include "core/debug/replay/steps.hpp"
#include "core/io/recording.hpp"
#include "core/model/types.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/analyze.hpp"
#include "render/draw_list.hpp"
#include "render/plane_colors.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {

struct MapView;
struct ReportPlace;
struct State;

// ---- Document ----------------------------------------------------------------------------------

struct OpenRecording {
  std::filesystem::path path;
  std::shared_ptr<const io::Recording> recording;
  std::filesystem::path label_dir;                  // may be missing
  std::shared_ptr<labels::LabelStore> labels = {};  // null until label mode is first entered
  io::PickedGravity picked = {};                    // contents of the file in label_dir
  std::string picked_refused = {};                  // why that file is ignored; empty: it is valid
};

/// A condition that stops playback. Stored by meaning rather than by step, so that it survives
/// reruns.
struct Breakpoint {
  enum class Kind : std::uint8_t { filter, node, point };
  Kind kind = Kind::filter;
  std::string filter;       // for filter: its text
  std::int32_t index = -1;  // for node; for point: a voxel
  bool enabled = true;

  bool operator==(const Breakpoint&) const = default;
};

/// Direction from which the whole frame is shown. Home is the one that shows most of it.
enum class Facing : std::uint8_t { home, top, side, front };

struct Bookmark {
  std::string name, note;
  int frame = 0;
  std::string frame_sha256;  // in sessions
  std::int32_t step = 0;
  std::int32_t node = -1, voxel = -1;
  std::int32_t plane = -1;  // its displayed number: 3 for P3
  std::string filter;
  render::Camera camera;
  std::optional<Facing> facing;  // the whole frame from this direction; nullopt: as in `camera`
  bool orthographic = false;
};

struct Document {
  std::vector<OpenRecording> recordings;
  int recording = -1;  // current one; -1: none
  int frame = 0;
  io::RecordingOptions recording_options;
  planes::PipelineOptions options;
  std::vector<Breakpoint> breakpoints;
  std::vector<Bookmark> bookmarks;
  std::vector<std::uint32_t> marked;          // voxels of the region marked by the user
  bool labels_written = false;                // since label mode was entered ...
  int labels_version = 0;                     // ... and when ground truth was last read
  std::filesystem::path session;              // last read or written session file
  std::vector<std::filesystem::path> recent;  // recently opened recordings, latest first

  const OpenRecording* current() const;
  OpenRecording* current();
  /// Throws Error if `out`, a file or folder to be written, is in an open recording.
  void check_output(const std::filesystem::path& out) const;
};

inline constexpr std::size_t kMostRecent = 10;
/// Moves an opened recording to the top of the list.
void note_recent(Document& document, const std::filesystem::path& recording);
/// Removes a recording that could not be opened. Returns whether it was in the list.
bool forget_recent(Document& document, const std::filesystem::path& recording);

// ---- Results -----------------------------------------------------------------------------------

/// Colors of a frame's planes; neighboring frames continue them.
struct FrameColors {
  std::shared_ptr<const render::ColoredPlanes> planes;  // null: the frame was not processed
  std::string key;                                      // run_key() of the options
  bool of_tracks = false;                               // taken from a map's tracks
};

/// True planes visible in a frame, numbered from 1.
struct TruePlanes {
  render::PlaneImage image;
  std::vector<int> ids;       // in the ground truth, ascending
  std::vector<int> found_of;  // the found plane matched with each, 0: none
};

/// A frame in the strip.
struct Thumbnail {
  bool ready = false;
  Image8 image;    // planes over the camera image; empty if the frame was refused
  int planes = 0;  // -1: not computed; labeling only needs the picture
  std::optional<debug::QuickScore> score;  // with ground truth
  std::string refusal;                     // why there is no result
  FrameColors colors;                      // of its planes
};

/// A run and its derived data for panels.
struct RunView {
  std::shared_ptr<const debug::Run> run;
  std::vector<debug::Histogram> histograms;
  debug::FrameSummary summary;
  std::optional<debug::QuickScore> score;
  render::Home home;  // of the frame, the same for all of its runs
  std::shared_ptr<const render::PlaneScene> outlines = {};  // of its planes; null: none
  std::shared_ptr<const MapView> map = {};  // the map that provides gravity; null: the frame's own
  std::shared_ptr<const std::vector<render::DrawLines>> map_lines = {};  // its planes
  FrameColors colors = {};
  TruePlanes truth = {};  // empty: no ground truth
};

/// Analysis of a run's planes, computed later, with options that do not affect the run.
struct RunPlanes {
  std::shared_ptr<const RunView> of;
  std::string key;  // of these options
  planes::FramePlanes found;
  std::shared_ptr<const render::PlaneScene> scene;
};

/// The question behind a click: the desired result for the surface at a voxel.
struct PointAsked {
  std::uint32_t voxel = 0;
  debug::Wish wish = debug::Wish::plane;
  std::int32_t with = -1;  // voxel of the other surface, for `joined` and `own_plane`

  bool operator==(const PointAsked&) const = default;
};

struct FixSearch : Asked {
  std::shared_ptr<const RunView> of;  // the run to fix
  std::optional<PointAsked> asked;    // from a click; the job derives the target from it
  debug::FixTarget target;
  bool finished = false;  // fixes are complete
  bool granted = false;   // already fulfilled
  std::vector<debug::Fix> fixes;
  int checked = -1;                       // fix whose effect is shown
  bool check_begun = false;               // a job has started the check
  std::vector<debug::FixEffect> effects;  // of the fix, on the labeled frames of the recording
};

/// Tracks of planes over all frames of a recording.
struct MapResults : Asked {
  std::shared_ptr<const MapView> made;  // the latest; may belong to another recording
};

struct Results {
  std::shared_ptr<const RunView> current;  // B, with the current options; null before the first run
  std::shared_ptr<const RunView> pinned;   // A ...
  FrameColors pinned_colors;               // ... and its displayed colors
  std::vector<std::shared_ptr<const RunPlanes>> planes;  // of these two, if known
  std::shared_ptr<const debug::Comparison> comparison;   // A with B, or truth with B
  std::shared_ptr<const RunView> compared_a;             // compared runs: `current` may be newer
  std::shared_ptr<const RunView> compared_b;             // `compared_a` null: the ground truth
  std::string refusal;                                   // why the frame was refused, one line
  bool loading = false;                                  // a frame is being read and prepared
  std::vector<Thumbnail> strip;                          // of the current recording
  int strip_done = 0;
  std::map<std::string, debug::Sensitivity> sensitivity;  // by option, for `current`
  FixSearch fix;
  MapResults map;
  LabelResults label;
};

// ---- View --------------------------------------------------------------------------------------

struct Selection {
  std::int32_t node = -1;
  std::int32_t plane = -1;  // index in the trace
  std::int32_t voxel = -1;
  std::int64_t source = -1;  // picked pixel v * width + u; -1: the voxel itself
};

/// Fractions of the window, changed by dragging the splitters.
struct Layout {
  double left = 0.135;   // recordings and frames
  double right = 0.285;  // inspector and tools
  double bottom = 0.34;  // octree and events
  double image = 0.55;   // of the middle, at most; no larger than its picture
  double octree = 0.40;  // of the bottom
  double tools = 0.48;   // of the right: criteria and the other tools
};

/// Views in the middle of the window.
enum class Views : std::uint8_t { both, scene, image };

struct LayoutPart {
  const char* name;
  double Layout::*share;
};
inline constexpr LayoutPart kLayoutParts[] = {
    {"left", &Layout::left},   {"right", &Layout::right},   {"bottom", &Layout::bottom},
    {"image", &Layout::image}, {"octree", &Layout::octree}, {"tools", &Layout::tools}};

/// The table of planes.
struct PlanesView {
  std::string filter;  // words that a row must contain
  int sorted_by = 0;   // column of plane_columns()
  bool descending = false;
};

struct Search {
  std::string text;
  debug::FilterProblem problem;         // message empty: the filter is valid
  std::optional<debug::Filter> filter;  // parsed text; nullopt if it is empty or invalid
  std::vector<std::int32_t> matches;    // matching steps of the shown run
};

/// Automatic playback of the trace.
struct Playing {
  int direction = 0;  // 0: paused
  double steps_per_s = 60;
  double due = 0;  // accumulated fraction of a step
};

/// A camera position.
struct CameraPlace {
  std::optional<render::Camera> camera;  // nullopt: show the whole frame ...
  Facing facing = Facing::home;          // ... from this direction
};
/// Camera undo and redo.
struct CameraHistory {
  std::vector<CameraPlace> before, after;
  bool held = false;   // further motion belongs to the latest undo step
  bool zooms = false;  // the latest step is a wheel zoom, which the next notch extends
};

/// Colors points by case instead of by plane while the user steps back through the traversal.
enum class CaseColors : std::uint8_t {
  ready,     // shown at the next step back
  shown,     // until the cursor is at the end again
  declined,  // the user chose other colors
};

enum class TrackColor : std::uint8_t { track, area, rms };
/// A track in a frame, shown once the frame's run is available. `camera` is in map coordinates;
/// nullopt keeps the current one.
struct TrackPlace {
  int track = 0, frame = 0;
  std::optional<render::Camera> camera = {};
};
/// State of the track timeline.
struct TracksView {
  int track = 0;               // selected; 0: none
  std::string filter;          // of rows ...
  std::string filter_problem;  // ... and why it is invalid
  TrackColor color_by = TrackColor::track;
  std::optional<TrackPlace> place;
};

/// Pictures of steps being written to one file.
struct StepsSaving {
  std::filesystem::path path;
  std::weak_ptr<const debug::Run> run;
  std::int32_t first = 0, last = 0, every = 1;  // the last step is always included
  int per_s = 10;
  int taken = 0, written = 0;  // number of pictures
  bool hidden = false;         // hide progress messages while a picture is drawn
  bool cancelled = false;      // requested by the user

  int count() const { return (last - first + every - 1) / every + 1; }
  std::int32_t step(int picture) const {
    return picture + 1 == count() ? last : first + picture * every;
  }
};

enum class Against : std::uint8_t { nothing, pinned, truth };
/// Effect of a click in a view: select, pick a floor or wall to derive gravity, or measure from a
/// point or plane.
enum class Click : std::uint8_t { selects, floor, wall, point, plane };
inline bool picks_gravity(Click click) { return click == Click::floor || click == Click::wall; }
inline bool measures(Click click) { return click == Click::point || click == Click::plane; }

inline constexpr double kLeastPointSize = 0.25, kMostPointSize = 4;

struct ViewState : render::StepChoices {
  ViewState() {
    color_by = render::ColorBy::planes;
    show_queue = show_settled = show_normals = false;
  }

  Mode mode = Mode::debugger;
  LabelView label;
  std::int32_t step = 0;
  debug::StepUnit step_unit = debug::StepUnit::event;
  std::optional<debug::StepRange> shown_steps;  // on the timeline; nullopt: the traversal
  CaseColors case_colors = CaseColors::ready;
  Selection selected;
  Search search;
  PlanesView planes;
  TracksView tracks;
  Playing playing;
  bool playing_frames = false;  // play the recording's frames, waiting for the planes of each
  double frame_due = 0;         // how long the frame has been shown

  // 3D and image views.
  std::optional<render::Camera> camera;  // nullopt: show the whole frame ...
  Facing facing = Facing::home;          // ... from this direction
  CameraHistory cameras;
  bool orthographic = false;
  double scene_aspect = 4.0 / 3;  // aspect ratio of the 3D view in the last frame
  bool show_map = false;          // planes seen up to this frame
  render::Backdrop backdrop = render::Backdrop::color;
  double overlay_opacity = 0.55;
  double image_zoom = 1;
  Vec2d image_center = Vec2d(0.5, 0.5);  // center of the view, as a fraction of the image

  // Panels.
  double zoom = 1;  // of the whole interface, on top of the screen scale
  Layout layout;
  Views views = Views::both;
  std::string inspector_tab = "inspector";  // inspector | planes | point | stairs | bookmarks
  std::string tool_tab = "criteria";        // criteria | histograms | compare | fix
  std::string list_tab = "events";          // events | tracks
  std::string octree_search;
  bool only_matches = false;  // the event list shows only matches
  bool show_keys = false, show_palette = false, show_timing = false;
  bool marking = false;  // dragging in the image marks a region
  Click click = Click::selects;
  std::vector<debug::MeasureEnd> measured;  // none, one or two ends
  bool gravity_of_recording = false;        // clicks apply to all frames instead of only this one
  Against against = Against::nothing;
  bool flash = false;     // show A instead of B
  bool wiper = false;     // A left of a divider and B right of it, in both views ...
  double wiper_at = 0.5;  // ... at this fraction of their width
  struct Preview {
    std::string option, value;
  };
  std::optional<Preview> preview;  // of a fix, while its button is held
  std::int32_t truth_plane = 0;    // target of `what would fix this`; 0: the marked region

  std::string palette_asks;         // action whose argument the palette asks for; empty: none
  std::optional<Bookmark> arrival;  // shown once the frame's run is ready
  std::shared_ptr<const ReportPlace> report_place;  // likewise; run A is needed too
  bool strip_stopped = false;
  std::string focus;     // widget to focus in the next frame
  std::string keyboard;  // panel with keyboard focus; empty: keys trigger actions
  std::string message;   // in the status bar, until the next one
  bool message_is_error = false;
  bool did_nothing = false;                     // the last action had no effect
  std::function<bool(const State&)> hint_done;  // the message is a hint until this returns true
  std::string picture_to;                       // path for a picture of the next frame
  std::optional<StepsSaving> saving;
  std::string to_clipboard;                  // copied by the window in the next frame
  bool edits_intrinsics = false;             // show the form even if the recording has intrinsics
  std::filesystem::path assumptions_hidden;  // recording with dismissed assumptions
  bool quit = false;
};

/// Picked gravity of a recording before and after a click.
struct GravityChange {
  std::filesystem::path recording;
  io::PickedGravity before, after;
};

/// One undo step: the options before and after a gesture.
struct OptionChange {
  planes::PipelineOptions before, after;
  std::string gesture;                   // changes with the same gesture are one step
  std::optional<GravityChange> gravity;  // if the gesture picked or cleared gravity
};

struct State {
  Document document;
  Results results;
  ViewState view;
  std::vector<OptionChange> undo, redo;

  /// The shown run: B, or A while it is flashed. Null before the first run.
  const debug::Run* run() const;
  const RunView* run_view() const;
  /// The other run, if A and B are both shown; otherwise null.
  const RunView* other_view() const;
  /// Analysis of a run's planes; null until available.
  const RunPlanes* planes(const RunView* of) const;
  const RunPlanes* planes() const { return planes(run_view()); }
  /// Outlines of a run's planes; null until available.
  std::shared_ptr<const render::PlaneScene> plane_scene(const RunView* of) const;
  /// Map of the current recording; null if its planes were not tracked.
  const MapView* map() const;
  /// "A", "B", or "A | B" for both; empty without A.
  std::string shown_side() const;
  /// The current frame in label mode; null while loading or if it cannot be labeled.
  const LabelFrame* label_frame() const;
  /// Its labels; null if label_frame() is null.
  std::shared_ptr<const FrameLabels> labels() const;
  /// The event before the cursor; null at step 0.
  const planes::TraceEvent* event() const;
};

// ---- Facts, for scripts and for tests that wait for the window ---------------------------------

/// {"recording", "frame", "step", "steps", "event", "node", "case", "planes", "matches", ...}; see
/// docs/desktop.md.
nlohmann::ordered_json state_facts(const State& state, bool idle);
/// The same as text for a file. Bytes that are not valid UTF-8, e.g. in paths, are replaced.
std::string state_text(const State& state, bool idle);

}  // namespace planescope::desktop
