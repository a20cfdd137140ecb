#pragma once

// Every action by subject, the types of their arguments, and what several of them share.

#include "app/desktop/actions/action.hpp"

namespace planescope::desktop {

struct RunArrival;

// Tables, in the order of menus and lists; each adds its rows.
void add_document_actions(std::vector<Action>& all);
void add_label_mode_actions(std::vector<Action>& all);  // in and out, history, saving
void add_view_actions(std::vector<Action>& all);
void add_camera_actions(std::vector<Action>& all);
void add_step_actions(std::vector<Action>& all);    // and which steps the timeline shows
void add_search_actions(std::vector<Action>& all);  // filter, breakpoints
void add_selection_actions(std::vector<Action>& all);
void add_option_actions(std::vector<Action>& all);
void add_compare_actions(std::vector<Action>& all);  // A/B, fixes
void add_label_tool_actions(std::vector<Action>& all);
void add_label_draw_actions(std::vector<Action>& all);
void add_label_plane_actions(std::vector<Action>& all);
void add_review_actions(std::vector<Action>& all);  // queue, checks
void add_learning_actions(std::vector<Action>& all);
void add_gravity_actions(std::vector<Action>& all);  // floors and walls that are clicked
void add_measure_actions(std::vector<Action>& all);  // and the table of planes
void add_track_actions(std::vector<Action>& all);

/// What most actions of the debugger need: a frame was segmented.
bool has_run(const State& state);

// ---- Types of arguments ------------------------------------------------------------------------

/// A plane of the run, as the trace counts it. Text: "3" or "P3".
struct PlaneRef {
  std::int32_t plane = -1;
};
/// A place on the depth image [px]. Text: "U,V".
struct Pixel {
  double u = 0, v = 0;
};
/// Pixel v * width + u of the run's depth image.
inline Pixel pixel_of(std::int64_t source, int width) {
  return {static_cast<double>(source % width), static_cast<double>(source / width)};
}
/// What a click in a view hits. Text: "U,V", "voxel N", "plane N" or "nothing".
struct Clicked {
  enum class On : std::uint8_t { nothing, pixel, voxel, plane } on = On::nothing;
  Pixel pixel = {};
  std::int32_t index = -1;  // voxel, or plane of the trace
  std::string why = {};     // text that names nothing is a click on nothing, for this reason
};
/// What should become of the selected point. Text: "plane", "own", "none" or "with VOXEL".
struct PointWish {
  debug::Wish wish = debug::Wish::plane;
  int with = -1;  // a voxel
};
/// An option and its value as the table of options reads it. Text: "NAME=VALUE".
struct OptionValue {
  std::string name, value;
};
/// Text: "left=0.2".
struct LayoutShare {
  double Layout::*part;
  double share;
};
struct BookmarkNote {
  int bookmark = 0;
  std::string note;
};
/// Text: "TRACK" or "TRACK,FRAME".
struct TrackFrame {
  int track = 0;
  std::optional<int> frame = {};
};
/// Text: "FX,FY,CX,CY [METERS_PER_COUNT [remember]]".
struct CameraEntry {
  std::array<double, 4> intrinsics = {};
  std::optional<double> depth_unit_m = {};
  bool remember = false;  // beside the recording
};
/// What all tools of the label mode do to slivers.
enum class SliverAction : std::uint8_t { show, keep, take, ignore };

/// What a click in a view is handed to; null where it selects.
const char* click_action(Click click);
Takes<Clicked> clicked();
/// The pixel v * width + u, or the index. Throws Error, a phrase, where nothing is there.
std::int64_t expect_clicked(const State& state, const Clicked& clicked);

// ---- The cursor --------------------------------------------------------------------------------

/// Moves the cursor, and selects what its event is about.
void go_to_step(State& state, std::int32_t step);
/// Moves the cursor as stepping and playing do: by so many events, nodes or changes of planes, back
/// where `count` is negative. Stepping back into the traversal colors by case.
void step_by(State& state, int count);
/// Evaluates the search on the run that is shown.
void refresh_matches(State& state);
void set_filter(State& state, const std::string& text);
/// What a breakpoint stops at, in the language of filters.
std::string filter_of(const Breakpoint& breakpoint);
/// Every step at which a breakpoint stops, ascending.
std::vector<std::int32_t> breakpoint_steps(const debug::Run& run, const Document& document);
/// A result has arrived, or a flash begun: cursor and selection move to the same node and event.
void follow_run(State& state, const debug::Run& before);
/// Goes to where a run's story begins, and selects what it is about.
void show_arrival(State& state, const RunArrival& arrival);
/// Selects a track's plane in the run looked at, or goes to the decision that lost it.
void go_to_track(State& state, const TrackPlace& place);
/// Shows B again where A is flashed.
void unflash(State& state);
/// Starts the search for fixes that a click asks for, unless it runs or has ended already.
void ask_of_point(State& state, const PointAsked& asked, bool far = false);

// ---- The camera --------------------------------------------------------------------------------

/// Looks from elsewhere; nothing: at all of the frame. An undo step of the camera's, but for what
/// moves it while it is held.
void move_camera(State& state,
                 const std::optional<render::Camera>& camera,
                 Facing facing = Facing::home);
/// Back to the frame's own view where the world is another one.
void forget_cameras(State& state);

// ---- The document ------------------------------------------------------------------------------

/// The nearest frame there is; drops what belonged to the one before.
void show_frame(State& state, int frame);
/// Goes on to the next frame once this one has been looked at; stops at the last.
void play_frames(State& state, double seconds);
/// Where one is, without a name.
Bookmark bookmark_here(const State& state);
/// Throws Error where the recording has no such frame, the state unchanged.
void go_to_bookmark(State& state, const Bookmark& bookmark);
/// New options as an undo step of their own.
void change_options(State& state, const planes::PipelineOptions& after);
/// Reads the gravity that was picked for a recording being opened. A file that cannot be used is
/// reported, and the recording opens without it.
void read_picked(State& state, OpenRecording& open);
/// Keeps the gravity picked for an open recording, in its label folder and in the document. Throws
/// Error, nothing changed, where it cannot be written.
void keep_picked(State& state,
                 const std::filesystem::path& recording,
                 const io::PickedGravity& picked);

// ---- Labels ------------------------------------------------------------------------------------

/// Saves, and goes back to the debugger.
void leave_label_mode(State& state);
/// Drops what was drawn on the frame but is no label yet.
void let_go(LabelView& view);
/// An undo step: into the journal and onto the screen. Throws Error where the frame is not ready or
/// the folder is read-only.
labels::LabelEdit commit_labels(State& state, const std::string& title, const FrameLabels& after);
/// Opens the label folder of the recording looked at. Throws Error where it cannot be used.
void open_labels(State& state);
/// Writes the label files where something is not written yet. Throws Error where that fails.
void save_labels(State& state);
/// The same where leaving must not be blocked: a failure is reported, and the journal has
/// everything.
void save_labels_if_possible(State& state);

// ---- The status bar ----------------------------------------------------------------------------

void say(State& state, std::string message, bool is_error = false);
/// Suggests what could be done next, until it is done.
void say_hint(State& state, std::string hint, std::function<bool(const State&)> done);
/// Removes a hint that is done.
void drop_done_hint(State& state);
/// Shows why nothing was changed; scripts print it to stderr.
void say_nothing_done(State& state, std::string why, bool is_error = false);

}  // namespace planescope::desktop
