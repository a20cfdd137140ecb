#pragma once

// Every action of the desktop: its name, its key, its place in the menu, and what it does. Panels,
// keys, menus, the palette and scripts all speak in commands.

#include <functional>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

struct RunArrival;

/// "step.next", or "filter.set" with "case==III".
struct Command {
  std::string action;
  std::string argument;
};

/// In which mode an action and its key work. A key of one mode goes before one that works anywhere.
enum class KeyMode : std::uint8_t { anywhere, debugger, labels };

struct Action {
  std::string name;   // "step.next"
  std::string title;  // "Step forward"
  std::string menu;   // "Step"; empty: in no menu
  std::string keys;   // "Right", "Shift+F5"; several apart by spaces; empty: none
  std::string takes;  // what the argument is, in brackets where it may be left out; empty: none
  std::function<void(State&, const std::string&)> run;
  std::function<bool(const State&)> enabled;  // empty: always
  std::function<bool(const State&)> checked;  // empty: not a switch
  KeyMode mode = KeyMode::anywhere;
  bool key_is_argument = false;  // "3" runs it with "3"

  bool can_run(const State& state) const { return !enabled || enabled(state); }
  bool is_on(const State& state) const { return checked && checked(state); }
};

const std::vector<Action>& action_table();
/// What the views emit for a click: "U,V", "voxel N", "plane N", or "nothing".
inline constexpr const char* kClickTakes = "U,V | voxel N | plane N";
/// What most actions of the debugger need: a frame was segmented.
bool has_run(const State& state);
/// Throws Error naming the nearest existing action.
const Action& find_action(const std::string& name);
/// Whether a key or menu must ask for its argument first.
bool needs_argument(const Action& action);
/// What a click in a view is handed to as kClickTakes; null where it selects.
const char* click_action(Click click);
/// Null where no action has this key ("Ctrl+P") in that mode.
const Action* action_of_key(const std::string& key, Mode mode);
/// The action can be used in that mode.
bool fits(const Action& action, Mode mode);
/// The first of its keys, as menus show it; empty where it has none.
std::string first_key(const Action& action);

/// Changes the state. Throws Error on an unknown action or an argument it cannot take, the state
/// unchanged.
void apply(State& state, const Command& command);

/// What the palette offers: actions, and recent recordings to open.
struct Offer {
  const Action* action = nullptr;
  std::string argument, title;
};
/// Those whose titles or names fit what was typed, best first: those with each word of it as a
/// whole word, then as the start of one, then anywhere; last those with its letters in order.
std::vector<Offer> palette_offers(const State& state, const std::string& typed);

// Tables by subject; action_table() is all of them.
std::vector<Action> step_actions();
std::vector<Action> timeline_actions();  // which steps the timeline shows
std::vector<Action> search_actions();
std::vector<Action> selection_actions();
std::vector<Action> option_actions();
std::vector<Action> compare_actions();
std::vector<Action> view_actions();
std::vector<Action> camera_actions();
std::vector<Action> document_actions();
std::vector<Action> gravity_actions();       // floors and walls that are clicked
std::vector<Action> plane_table_actions();   // the table of planes
std::vector<Action> measure_actions();       // between points and planes that are clicked
std::vector<Action> map_actions();           // following planes over all frames
std::vector<Action> track_actions();         // what came of it
std::vector<Action> label_mode_actions();    // in and out, history, saving
std::vector<Action> label_tool_actions();    // what is in hand: tool, plane, sizes
std::vector<Action> label_draw_actions();    // strokes, areas, cuts, the wand
std::vector<Action> label_finish_actions();  // holes, borders, specks, the view of distances
std::vector<Action> label_chain_actions();   // a plane on all frames it was carried over
std::vector<Action> label_plane_actions();   // the active plane, its class, join, split, carry
std::vector<Action> label_review_actions();  // queue, checks
std::vector<Action> label_learn_actions();   // a classifier that learns from reviewed frames

// Arguments from text. All throw Error naming the action and what was expected.

int whole_argument(const std::string& action, const std::string& text, int low, int high);
/// A plane of the run by its name, "3" or "P3"; as the trace counts it.
std::int32_t run_plane_argument(const State& state,
                                const std::string& action,
                                const std::string& text);
/// "3" or "P3".
int plane_argument(const std::string& action, const std::string& text, int low, int high);
/// The item of a list by its number, from 0.
template <typename Items>
auto& item_argument(const std::string& action, const std::string& text, Items& items) {
  const int last = static_cast<int>(items.size()) - 1;
  return items[static_cast<std::size_t>(whole_argument(action, text, 0, last))];
}
double number_argument(const std::string& action, const std::string& text);
/// "12.5,3,7" as exactly `count` numbers.
std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count);
/// Starts the search for fixes that a click asks for, unless it runs or has ended already.
void ask_of_point(State& state, const PointAsked& asked, bool far = false);
/// What was clicked, as kClickTakes has it. Throws Error, a phrase, where nothing is there.
struct Clicked {
  enum class On : std::uint8_t { pixel, voxel, plane } on = On::pixel;
  std::int32_t index = 0;  // v * width + u, voxel, plane of the trace
};
Clicked click_argument(const State& state, const std::string& action, const std::string& text);
/// The index of `text` among `names`.
int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names);

// Used by several tables.

/// Moves the cursor, and selects what its event is about.
void go_to_step(State& state, std::int32_t step);
/// Moves the cursor as stepping and playing do: by so many events, nodes or changes of planes, back
/// where `count` is negative. Stepping back into the traversal colors by case.
void step_by(State& state, int count);
/// The colors after the user has stepped back from a step.
void color_traversal(State& state, std::int32_t from);
/// Evaluates the search on the run that is shown.
void refresh_matches(State& state);
/// What a breakpoint stops at, in the language of filters.
std::string filter_of(const Breakpoint& breakpoint);
/// Every step at which a breakpoint stops, ascending.
std::vector<std::int32_t> breakpoint_steps(const debug::Run& run, const Document& document);
/// A result has arrived, or a flash begun: cursor and selection move to the same node and event.
void follow_run(State& state, const debug::Run& before);
/// Looks from elsewhere; nothing: at all of the frame. An undo step of the camera's, but for what
/// moves it while it is held.
void move_camera(State& state,
                 const std::optional<render::Camera>& camera,
                 Facing facing = Facing::home);
/// Back to the frame's own view where the world is another one.
void forget_cameras(State& state);
/// Goes to where a run's story begins, and selects what it is about.
void show_arrival(State& state, const RunArrival& arrival);
/// Selects a track's plane in the run looked at, or goes to the decision that lost it.
void go_to_track(State& state, const TrackPlace& place);
/// Shows B again where A is flashed.
void unflash(State& state);
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
/// Drops what was drawn on the frame but is no label yet.
void let_go(LabelView& view);
/// An undo step: into the journal and onto the screen. Throws Error where the frame is not ready or
/// the folder is read-only.
void commit_labels(State& state, const std::string& title, const FrameLabels& after);
/// Opens the label folder of the recording looked at. Throws Error where it cannot be used.
void open_labels(State& state);
/// Writes the label files where something is not written yet. Throws Error where that fails.
void save_labels(State& state);
/// The same where leaving must not be blocked: a failure is reported, and the journal has
/// everything.
void save_labels_if_possible(State& state);
/// In the status bar.
void say(State& state, std::string message, bool is_error = false);
/// What could be done next: told until it is done.
void say_hint(State& state, std::string hint, std::function<bool(const State&)> done);
/// Takes a hint away whose time is over.
void drop_done_hint(State& state);
/// That what was asked for changed nothing, and why; whoever plays a script is told.
void say_nothing_done(State& state, std::string why);

}  // namespace planescope::desktop
