#pragma once

// The desktop in plain data: the document (what is worked on), the results (immutable, made by
// jobs) and the view (what is looked at). Panels read it; apply() in actions.hpp is all that
// changes it, besides the jobs that hand in results.

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
  std::filesystem::path label_dir;                  // may not exist
  std::shared_ptr<labels::LabelStore> labels = {};  // null before the label mode was entered on it
  io::PickedGravity picked = {};                    // as it lies in label_dir
  std::string picked_refused = {};                  // why it is left alone; empty: it could be read
};

/// Where running stops. Kept by what it means, so that it outlives a run.
struct Breakpoint {
  enum class Kind : std::uint8_t { filter, node, point };
  Kind kind = Kind::filter;
  std::string filter;       // for filter: its text
  std::int32_t index = -1;  // for node, and for point: a voxel
  bool enabled = true;

  bool operator==(const Breakpoint&) const = default;
};

/// From where all of the frame is looked at. Home: from where most is seen.
enum class Facing : std::uint8_t { home, top, side, front };

struct Bookmark {
  std::string name, note;
  int frame = 0;
  std::string frame_sha256;  // in sessions
  std::int32_t step = 0;
  std::int32_t node = -1, voxel = -1;
  std::int32_t plane = -1;  // what it is called by: 3 is P3
  std::string filter;
  render::Camera camera;
  std::optional<Facing> facing;  // all of the frame, from there; nothing: as the camera stands
  bool orthographic = false;
};

struct Document {
  std::vector<OpenRecording> recordings;
  int recording = -1;  // the one looked at; -1: none
  int frame = 0;
  io::RecordingOptions recording_options;
  planes::PipelineOptions options;
  std::vector<Breakpoint> breakpoints;
  std::vector<Bookmark> bookmarks;
  std::vector<std::uint32_t> marked;          // voxels of the region that the user marked
  bool labels_written = false;                // since the label mode was entered ...
  int labels_version = 0;                     // ... and as the debugger's ground truth was read
  std::filesystem::path session;              // the file that it was read from or written to last
  std::vector<std::filesystem::path> recent;  // recordings that were opened, the latest first

  const OpenRecording* current() const;
  OpenRecording* current();
};

inline constexpr std::size_t kMostRecent = 10;
/// The recording was opened: it is the latest.
void note_recent(Document& document, const std::filesystem::path& recording);
/// It could not be opened. True where it was among the recent ones.
bool forget_recent(Document& document, const std::filesystem::path& recording);

// ---- Results -----------------------------------------------------------------------------------

/// Colors of a frame's planes; those of its neighbors follow from them.
struct FrameColors {
  std::shared_ptr<const render::ColoredPlanes> planes;  // null: the frame was not run
  std::string key;                                      // run_key() of the options
  bool of_tracks = false;                               // a map's tracks decided
};

/// True planes that a frame shows, numbered from 1 on.
struct TruePlanes {
  render::PlaneImage image;
  std::vector<int> ids;       // in the ground truth, ascending
  std::vector<int> found_of;  // the found plane that each was matched with, 0 none
};

/// A frame as the strip shows it.
struct Thumbnail {
  bool ready = false;
  Image8 image;    // planes over the camera's image; empty where the frame was refused
  int planes = 0;  // -1: none were looked for, a picture is all that labeling needs
  std::optional<debug::QuickScore> score;  // where it has ground truth
  std::string refusal;                     // why there is none
  FrameColors colors;                      // of its planes
};

/// A run with what panels show of it.
struct RunView {
  std::shared_ptr<const debug::Run> run;
  std::vector<debug::Histogram> histograms;
  debug::FrameSummary summary;
  std::optional<debug::QuickScore> score;
  render::Home home;  // the frame's own, the same for all runs on it
  std::shared_ptr<const render::PlaneScene> outlines = {};  // of its planes; null: there are none
  std::shared_ptr<const MapView> map = {};  // whose gravity the frame has; null: its own
  std::shared_ptr<const std::vector<render::DrawLines>> map_lines = {};  // its planes in the scene
  FrameColors colors = {};
  TruePlanes truth = {};  // empty: no ground truth
};

/// What is found out about a run's planes a little later, and by options that leave the run as it
/// is.
struct RunPlanes {
  std::shared_ptr<const RunView> of;
  std::string key;  // of these options
  planes::FramePlanes found;
  std::shared_ptr<const render::PlaneScene> scene;
};

/// What a click asks: what should become of the surface at a voxel.
struct PointAsked {
  std::uint32_t voxel = 0;
  debug::Wish wish = debug::Wish::plane;
  std::int32_t with = -1;  // a voxel of the other surface: `joined` with it, `own_plane` without it

  bool operator==(const PointAsked&) const = default;
};

struct FixSearch : Asked {
  std::shared_ptr<const RunView> of;  // whose fixes they are
  std::optional<PointAsked> asked;    // by a click: the job makes the target of it
  debug::FixTarget target;
  bool finished = false;  // fixes is what there is
  bool granted = false;   // it is so already
  std::vector<debug::Fix> fixes;
  int checked = -1;                       // the fix whose effect is shown
  bool check_begun = false;               // the job knows of that, too
  std::vector<debug::FixEffect> effects;  // of it, on the labelled frames of the recording
};

/// Planes that are followed over all frames of a recording.
struct MapResults : Asked {
  std::shared_ptr<const MapView> made;  // the latest; it may be another recording's
};

struct Results {
  std::shared_ptr<const RunView> current;  // B, what the options give; null before the first
  std::shared_ptr<const RunView> pinned;   // A ...
  FrameColors pinned_colors;               // ... and the colors that it was shown in
  std::vector<std::shared_ptr<const RunPlanes>> planes;  // of these two, as far as they are known
  std::shared_ptr<const debug::Comparison> comparison;   // A with B, or truth with B
  std::shared_ptr<const RunView> compared_a;             // what it compares: `current` may be newer
  std::shared_ptr<const RunView> compared_b;             // `compared_a` null: the truth
  std::string refusal;                                   // why the frame could not be run, one line
  bool loading = false;                                  // a frame is read and prepared
  std::vector<Thumbnail> strip;                          // of the recording looked at
  int strip_done = 0;
  std::map<std::string, debug::Sensitivity> sensitivity;  // by option; of `current`
  FixSearch fix;
  MapResults map;
  LabelResults label;
};

// ---- View --------------------------------------------------------------------------------------

struct Selection {
  std::int32_t node = -1;
  std::int32_t plane = -1;  // of the trace
  std::int32_t voxel = -1;
  std::int64_t source = -1;  // pixel v * width + u that was picked, -1 where it is the voxel itself
};

/// Shares of the window, dragged at the splitters.
struct Layout {
  double left = 0.135;   // recordings and frames
  double right = 0.285;  // inspector and tools
  double bottom = 0.34;  // octree and events
  double image = 0.55;   // of the middle, at most: the image view is no larger than its picture
  double octree = 0.40;  // of the bottom
  double tools = 0.48;   // of the right: criteria and the other tools
};

/// What shares the middle of the window.
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
  std::string filter;  // words that a row has
  int sorted_by = 0;   // of plane_columns()
  bool descending = false;
};

struct Search {
  std::string text;
  debug::FilterProblem problem;         // message empty: the text is a filter
  std::optional<debug::Filter> filter;  // of text; nothing where it is empty or wrong
  std::vector<std::int32_t> matches;    // steps of the run shown
};

/// Automatic playback of the trace.
struct Playing {
  int direction = 0;  // 0: stands still
  double steps_per_s = 60;
  double due = 0;  // fraction of a step not taken yet
};

/// Where the camera is.
struct CameraPlace {
  std::optional<render::Camera> camera;  // nothing: all of the frame fills the view
  Facing facing = Facing::home;          // then from there
};
/// Where it was, for its own undo and redo.
struct CameraHistory {
  std::vector<CameraPlace> before, after;
  bool held = false;   // what moves it is part of the step that is there
  bool zooms = false;  // the latest step is of the wheel, whose next notch is part of it
};

/// Points are colored by case while the user steps back through the traversal, in place of by
/// plane.
enum class CaseColors : std::uint8_t {
  ready,     // they come with the next step back
  shown,     // until the cursor is at the end again
  declined,  // the user chose other colors meanwhile
};

enum class TrackColor : std::uint8_t { track, area, rms };
/// A track's place in a frame, to go to once its run is there. `camera`: in the map's world;
/// nothing: as it stands.
struct TrackPlace {
  int track = 0, frame = 0;
  std::optional<render::Camera> camera = {};
};
/// The timeline of tracks.
struct TracksView {
  int track = 0;               // selected; 0: none
  std::string filter;          // of rows ...
  std::string filter_problem;  // ... why it is none
  TrackColor color_by = TrackColor::track;
  std::optional<TrackPlace> place;
};

/// Pictures of steps that are being written into one file.
struct StepsSaving {
  std::filesystem::path path;
  std::weak_ptr<const debug::Run> run;
  std::int32_t first = 0, last = 0, every = 1;  // the last one in any case
  int per_s = 10;
  int taken = 0, written = 0;  // pictures
  bool hidden = false;         // nothing is told of it while the picture is drawn
  bool cancelled = false;      // to be given up

  int count() const { return (last - first + every - 1) / every + 1; }
  std::int32_t step(int picture) const {
    return picture + 1 == count() ? last : first + picture * every;
  }
};

enum class Against : std::uint8_t { nothing, pinned, truth };
/// What a click in a view does: selects, picks a floor or a wall from which gravity follows, or
/// measures from a point or a plane.
enum class Click : std::uint8_t { selects, floor, wall, point, plane };
inline bool tells_gravity(Click click) { return click == Click::floor || click == Click::wall; }
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
  std::optional<debug::StepRange> shown_steps;  // on the timeline; nothing: the traversal
  CaseColors case_colors = CaseColors::ready;
  Selection selected;
  Search search;
  PlanesView planes;
  TracksView tracks;
  Playing playing;
  bool playing_frames =
      false;             // of the recording, one after the other, each once it has its planes
  double frame_due = 0;  // seconds that the frame has been shown

  // 3D and image.
  std::optional<render::Camera> camera;  // nothing: all of the frame fills the view ...
  Facing facing = Facing::home;          // ... from there
  CameraHistory cameras;
  bool orthographic = false;
  double scene_aspect = 4.0 / 3;  // width by height of the room it has, as drawn last
  bool show_map = false;          // of the planes that were seen up to this frame
  render::Backdrop backdrop = render::Backdrop::color;
  double overlay_opacity = 0.55;
  double image_zoom = 1;
  Vec2d image_center = Vec2d(0.5, 0.5);  // of the view, as a share of the image

  // Panels.
  double zoom = 1;  // of everything, on top of the screen's own scale
  Layout layout;
  Views views = Views::both;
  std::string inspector_tab = "inspector";  // inspector | planes | point | stairs | bookmarks
  std::string tool_tab = "criteria";        // criteria | histograms | compare | fix
  std::string list_tab = "events";          // events | tracks
  std::string octree_search;
  bool only_matches = false;  // the event list shows what the filter finds
  bool show_keys = false, show_palette = false, show_timing = false;
  bool marking = false;  // dragging in the image marks a region
  Click click = Click::selects;
  std::vector<debug::MeasureEnd> measured;  // one end, or two
  bool gravity_of_recording = false;  // what is clicked holds for all frames, not this one alone
  Against against = Against::nothing;
  bool flash = false;     // A is shown in place of B
  bool wiper = false;     // A left of a divider and B right of it, in both views ...
  double wiper_at = 0.5;  // ... which is at this share of their width
  struct Preview {
    std::string option, value;
  };
  std::optional<Preview> preview;  // of a fix, while its button is held
  std::int32_t truth_plane = 0;    // that `what would fix this` is about; 0: the marked region

  std::string palette_asks;  // the palette asks for this action's argument; empty: for an action
  std::optional<Bookmark> arrival;                  // where to go once the frame's run is there
  std::shared_ptr<const ReportPlace> report_place;  // likewise; A is run, too
  bool strip_stopped = false;
  std::string focus;     // widget that takes the keyboard in the next frame
  std::string keyboard;  // panel whose widgets the keyboard moves through; empty: keys are actions'
  std::string message;   // status bar, until the next
  bool message_is_error = false;
  bool did_nothing = false;                     // it says that what was asked for changed nothing
  std::function<bool(const State&)> hint_done;  // it is a hint, until this holds
  std::string picture_to;                       // where the next frame is written as a picture
  std::optional<StepsSaving> saving;
  std::string to_clipboard;       // the window takes it in the next frame
  bool edits_intrinsics = false;  // the form is shown although the recording has intrinsics
  std::filesystem::path assumptions_hidden;  // recording whose assumptions the user dismissed
  bool quit = false;
};

/// What was picked for a recording before and after a click.
struct GravityChange {
  std::filesystem::path recording;
  io::PickedGravity before, after;
};

/// One undo step: the options before and after a gesture.
struct OptionChange {
  planes::PipelineOptions before, after;
  std::string gesture;                   // same gesture, same step
  std::optional<GravityChange> gravity;  // of one that picked or forgot gravity
};

struct State {
  Document document;
  Results results;
  ViewState view;
  std::vector<OptionChange> undo, redo;

  /// The run that is looked at: B, or A while it is flashed. Null before the first.
  const debug::Run* run() const;
  const RunView* run_view() const;
  /// A where B is looked at and the other way round, while both are shown; null: only one is.
  const RunView* other_view() const;
  /// What is known of a run's planes; null while it is found out.
  const RunPlanes* planes(const RunView* of) const;
  const RunPlanes* planes() const { return planes(run_view()); }
  /// What is drawn of a run's planes; null: nothing is known yet.
  std::shared_ptr<const render::PlaneScene> plane_scene(const RunView* of) const;
  /// Of the recording looked at; null: its planes were not followed.
  const MapView* map() const;
  /// "A", "B", both as "A | B"; empty where there is no A to tell apart.
  std::string shown_side() const;
  /// The frame looked at as labels are drawn on it; null while it is made, or cannot be.
  const LabelFrame* label_frame() const;
  /// Its labels; null where label_frame() is.
  std::shared_ptr<const FrameLabels> labels() const;
  /// The event that led to the cursor; null at step 0.
  const planes::TraceEvent* event() const;
};

// ---- Facts, for scripts that expect something and for whoever waits for the window -------------

/// {"recording", "frame", "step", "steps", "event", "node", "case", "planes", "matches", ...}; what
/// docs/desktop.md lists.
nlohmann::ordered_json state_facts(const State& state, bool idle);
/// The same as text for a file. Bytes that are not UTF-8, as in a path, are replaced.
std::string state_text(const State& state, bool idle);

}  // namespace planescope::desktop
