#pragma once

// All actions by topic, their argument types, and shared helpers.

#include <algorithm>
#include <any>
#include <array>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

// ---- Commands ----------------------------------------------------------------------------------

/// An action with its argument, either as a value of the action's type or, from outside the
/// program, as text: "filter.set" with "case==III".
struct Command {
  std::string action;
  std::string argument = {};
  std::any value = {};
};

/// Converts `value` for actions: integers to int, other numbers to double, text to std::string;
/// other types are unchanged.
template <typename T>
Command command(std::string action, const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>)
    return {std::move(action), {}, value};
  else if constexpr (std::is_integral_v<T>)
    return {std::move(action), {}, static_cast<int>(value)};
  else if constexpr (std::is_floating_point_v<T>)
    return {std::move(action), {}, static_cast<double>(value)};
  else if constexpr (std::is_convertible_v<T, std::string>)
    return {std::move(action), {}, std::string(value)};
  else
    return {std::move(action), {}, value};
}

// ---- Actions -----------------------------------------------------------------------------------

/// The mode in which an action and its key work. Keys of a mode take precedence over keys that work
/// anywhere.
enum class KeyMode : std::uint8_t { anywhere, debugger, labels };

using Condition = std::function<bool(const State&)>;

struct Action {
  std::string name;   // "step.next"
  std::string title;  // "Step forward"
  std::string menu;   // "Step"; empty: not in a menu
  std::string keys;   // "Right", "Shift+F5", separated by spaces; empty: none
  std::string takes;  // the argument, in brackets if optional; empty: none
  std::string words;  // search words in addition to title and name
  std::function<void(State&, const Command&)> run;
  Condition enabled;  // empty: always
  Condition checked;  // empty: not a toggle
  KeyMode mode = KeyMode::anywhere;
  bool key_is_argument = false;  // key "3" runs it with argument "3"

  bool can_run(const State& state) const { return !enabled || enabled(state); }
  bool is_on(const State& state) const { return checked && checked(state); }
};

const std::vector<Action>& action_table();
/// Throws Error that suggests the most similar action.
const Action& find_action(const std::string& name);
/// Whether keys and menus must ask for an argument first.
bool needs_argument(const Action& action);
/// Null if no action has this key ("Ctrl+P") in this mode.
const Action* action_of_key(const std::string& key, Mode mode);
/// Whether the action is available in this mode.
bool fits(const Action& action, Mode mode);
/// Its first key, as shown in menus; empty if there is none.
std::string first_key(const Action& action);

/// Changes the state. On an unknown action or an invalid argument, throws Error and leaves the
/// state unchanged.
void apply(State& state, const Command& command);

/// An entry of the palette: an action, or a recent recording to open.
struct Offer {
  const Action* action = nullptr;
  std::string argument, title;
};
/// Entries whose titles or names match the typed words, best first: whole words, then prefixes,
/// then substrings; last, titles that contain the letters in order.
std::vector<Offer> palette_offers(const State& state, const std::string& typed);

// ---- Arguments ---------------------------------------------------------------------------------

/// An argument type: its text in lists, its parser, and its currently valid values. Both functions
/// throw Error with the action and the expected value.
template <typename T>
struct Takes {
  std::string text;  // "NODE"
  std::function<T(const State&, const std::string& action, const std::string& text)> read;
  std::function<void(const State&, const std::string& action, const T&)> check = {};
};

Takes<std::string> text(std::string shown);
Takes<double> number(std::string shown);
/// "U0,V0,U1,V1": exactly `count` numbers.
template <std::size_t count>
Takes<std::array<double, count>> numbers(std::string shown);

struct Range {
  int low = 0, high = 0;
};
Takes<int> whole(std::string shown, std::function<Range(const State&)> range);
/// An index into a list.
template <typename Items>
Takes<int> item(std::string shown, Items&& items) {
  return whole(std::move(shown), [items](const State& s) {
    return Range{0, static_cast<int>(std::size(items(s))) - 1};
  });
}

/// One of "both|scene|image".
Takes<std::string> one_of(std::string names);
int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names);
std::vector<std::string> names_of(const std::string& choices);
/// The same for an enumeration in this order.
template <typename Enum>
Takes<Enum> choice(std::string names) {
  return {names, [all = names_of(names)](const State&, const std::string& action,
                                         const std::string& text) {
            return static_cast<Enum>(choice_argument(action, text, all));
          }};
}

/// An argument for which one text means "none".
template <typename T>
Takes<std::optional<T>> or_none(Takes<T> takes, std::string none = "none") {
  Takes<std::optional<T>> some;
  some.text = takes.text;
  some.read = [read = takes.read, none](const State& state, const std::string& action,
                                        const std::string& typed) {
    return typed == none ? std::nullopt : std::optional<T>(read(state, action, typed));
  };
  if (takes.check)
    some.check = [check = takes.check](const State& state, const std::string& action,
                                       const std::optional<T>& value) {
      if (value) check(state, action, *value);
    };
  return some;
}
/// An optional argument.
template <typename T>
Takes<std::optional<T>> maybe(Takes<T> takes) {
  takes.text = "[" + takes.text + "]";
  return or_none(std::move(takes), "");
}

// Parsers shared by several types. All throw Error with the action and the expected value.

int whole_argument(const std::string& action, const std::string& text, int low, int high);
/// "3" or "P3".
int plane_number_argument(const std::string& action, const std::string& text, int low, int high);
double number_argument(const std::string& action, const std::string& text);
/// Parses exactly `count` numbers, e.g. "12.5,3,7".
std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count);

template <std::size_t count>
Takes<std::array<double, count>> numbers(std::string shown) {
  return {std::move(shown), [](const State&, const std::string& action, const std::string& text) {
            const std::vector<double> read = numbers_argument(action, text, count);
            std::array<double, count> values = {};
            std::copy(read.begin(), read.end(), values.begin());
            return values;
          }};
}

// ---- Action tables -----------------------------------------------------------------------------

/// Returns the value of a command. A panel that passes another type is a bug, which throws.
template <typename T>
T value_in(const std::any& value, const Takes<T>&) {
  return std::any_cast<T>(value);
}
template <typename T>
std::optional<T> value_in(const std::any& value, const Takes<std::optional<T>>&) {
  const T* given = std::any_cast<T>(&value);
  return given ? *given : std::any_cast<std::optional<T>>(value);
}

/// A table row being added.
class ActionRow {
 public:
  ActionRow(Action& action, std::string menu) : action_(action), menu_(std::move(menu)) {}

  /// Adds it to the table's menu with these keys.
  ActionRow& key(std::string keys) {
    action_.keys = std::move(keys);
    return menu(menu_);
  }
  /// Adds it to the table's menu without a key.
  ActionRow& menu() { return menu(menu_); }
  ActionRow& menu(std::string name) {
    action_.menu = std::move(name);
    return *this;
  }
  ActionRow& words(std::string more) {
    action_.words = std::move(more);
    return *this;
  }
  /// Sets the condition for running, in place of the group's.
  ActionRow& when(Condition enabled) {
    action_.enabled = std::move(enabled);
    return *this;
  }
  ActionRow& in(KeyMode mode) {
    action_.mode = mode;
    return *this;
  }
  ActionRow& key_is_argument() {
    action_.key_is_argument = true;
    return *this;
  }
  /// Sets the condition under which the toggle is on.
  ActionRow& on(Condition checked) {
    action_.checked = std::move(checked);
    return *this;
  }
  ActionRow& run(std::function<void(State&)> does) {
    action_.run = [does = std::move(does)](State& state, const Command&) { does(state); };
    return *this;
  }
  template <typename T, typename Does>
  ActionRow& run(Takes<T> takes, Does does) {
    action_.takes = takes.text;
    action_.run = [takes = std::move(takes), does = std::move(does)](State& state,
                                                                     const Command& command) {
      const T value = command.value.has_value()
                          ? value_in(command.value, takes)
                          : takes.read(state, command.action, command.argument);
      if (takes.check) takes.check(state, command.action, value);
      does(state, value);
    };
    return *this;
  }
  /// Makes it a toggle of a flag in the view: `&ViewState::marking`, or the result of a generic
  /// function of the view.
  template <typename Flag>
  ActionRow& flips(Flag flag) {
    on([flag](const State& s) { return std::invoke(flag, s.view); });
    return run([flag](State& s) { std::invoke(flag, s.view) = !std::invoke(flag, s.view); });
  }

 private:
  Action& action_;
  std::string menu_;
};

/// Actions with the same menu, mode and condition.
struct ActionGroup {
  std::vector<Action>& all;
  KeyMode mode = KeyMode::anywhere;
  std::string menu = {};
  Condition when = {};

  ActionRow add(std::string name, std::string title) const {
    Action& action = all.emplace_back();
    action.name = std::move(name);
    action.title = std::move(title);
    action.mode = mode;
    action.enabled = when;
    return {action, menu};
  }
};

struct RunArrival;

// Tables in the order of menus and lists. Each function adds its rows.
void add_document_actions(std::vector<Action>& all);
void add_label_mode_actions(std::vector<Action>& all);  // entering and leaving, history, saving
void add_view_actions(std::vector<Action>& all);
void add_camera_actions(std::vector<Action>& all);
void add_step_actions(std::vector<Action>& all);    // and the range of the timeline
void add_search_actions(std::vector<Action>& all);  // filter, breakpoints
void add_selection_actions(std::vector<Action>& all);
void add_option_actions(std::vector<Action>& all);
void add_compare_actions(std::vector<Action>& all);  // A/B, fixes
void add_label_tool_actions(std::vector<Action>& all);
void add_label_draw_actions(std::vector<Action>& all);
void add_label_plane_actions(std::vector<Action>& all);
void add_review_actions(std::vector<Action>& all);  // queue, checks
void add_learning_actions(std::vector<Action>& all);
void add_gravity_actions(std::vector<Action>& all);  // clicked floors and walls
void add_measure_actions(std::vector<Action>& all);  // and the table of planes
void add_track_actions(std::vector<Action>& all);

/// Condition of most debugger actions: the frame has been segmented.
bool has_run(const State& state);

// ---- Argument types ----------------------------------------------------------------------------

/// A plane by its index in the trace. Text: "3" or "P3".
struct PlaneRef {
  std::int32_t plane = -1;
};
/// A position in the depth image [px]. Text: "U,V".
struct Pixel {
  double u = 0, v = 0;
};
/// Pixel v * width + u of the run's depth image.
inline Pixel pixel_of(std::int64_t source, int width) {
  return {static_cast<double>(source % width), static_cast<double>(source / width)};
}
/// The item clicked in a view. Text: "U,V", "voxel N", "plane N" or "nothing".
struct Clicked {
  enum class On : std::uint8_t { nothing, pixel, voxel, plane } on = On::nothing;
  Pixel pixel = {};
  std::int32_t index = -1;  // voxel, or plane of the trace
  std::string why = {};     // reason for text that matches nothing
};
/// The desired result for the selected point. Text: "plane", "own", "none" or "with VOXEL".
struct PointWish {
  debug::Wish wish = debug::Wish::plane;
  int with = -1;  // a voxel
};
/// An option and its value as text for the option table. Text: "NAME=VALUE".
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
/// A color mode of points: the action that selects it, its key, and its name in lists.
struct ColorChoice {
  render::ColorBy by;
  const char *action, *title, *key, *name;
};
/// In the order of render::ColorBy.
inline constexpr ColorChoice kColorChoices[] = {
    {render::ColorBy::cases, "color.cases", "Color by case", "1", "case"},
    {render::ColorBy::planes, "color.planes", "Color by plane", "2", "plane"},
    {render::ColorBy::labels, "color.labels", "Color by horizontal and vertical", "3",
     "horizontal or vertical"},
    {render::ColorBy::margins, "color.margins", "Color by label margin", "4", "sureness"},
    {render::ColorBy::truth, "color.truth", "Color by ground truth", "5", "truth"},
    {render::ColorBy::camera, "color.camera", "Color from the camera", "6", "camera"},
    {render::ColorBy::steppable, "color.steppable", "Color by steppable", "7", "steppable"},
    {render::ColorBy::depth, "color.depth", "Color by depth", "8", "depth"},
    {render::ColorBy::height, "color.height", "Color by height", "9", "height"},
    {render::ColorBy::rms, "color.rms", "Color by RMS", "0", "RMS"},
    {render::ColorBy::distance, "color.distance", "Color by distance to a plane", "Shift+0",
     "distance"}};
/// Actions on slivers, available with all label tools.
enum class SliverAction : std::uint8_t { show, keep, take, ignore };

/// The selected point as pixel v * width + u, or as an index into a cloud; nullopt without a
/// selection.
std::optional<std::size_t> source_of(const Selection& selected, const debug::Subject& subject);
/// Adds a toggle that sets what a click in a view does.
ActionRow add_click(
    const ActionGroup& group, const char* name, const char* title, const char* key, Click what);
/// The action that receives clicks in a view; null if they select.
const char* click_action(Click click);
Takes<Clicked> clicked();
/// The pixel v * width + u, or the index. Throws Error with a phrase if nothing was hit.
std::int64_t expect_clicked(const State& state, const Clicked& clicked);

// ---- The cursor --------------------------------------------------------------------------------

/// Moves the cursor and selects the item of its event.
void go_to_step(State& state, std::int32_t step);
/// Moves the cursor like stepping and playback, by `count` events, nodes or plane changes; negative
/// is backwards. Stepping back into the traversal switches to colors by case.
void step_by(State& state, int count);
/// Evaluates the search on the shown run.
void refresh_matches(State& state);
void set_filter(State& state, const std::string& text);
/// The condition of a breakpoint as a filter.
std::string filter_of(const Breakpoint& breakpoint);
/// All steps at which enabled (or disabled) breakpoints stop, ascending.
std::vector<std::int32_t> breakpoint_steps(const debug::Run& run,
                                           const std::vector<Breakpoint>& all,
                                           bool enabled = true);
/// Call when a result has arrived or flashing began: moves the cursor and selection to the same
/// node and event.
void follow_run(State& state, const debug::Run& before);
/// Goes to the start of an arrival and selects its item.
void show_arrival(State& state, const RunArrival& arrival);
/// Selects a track's plane in the current run, or goes to the decision that lost it.
void go_to_track(State& state, const TrackPlace& place);
/// Shows B again if A is flashed.
void unflash(State& state);
/// Starts the search for fixes for a clicked point, unless it is running or finished.
void ask_of_point(State& state, const PointAsked& asked, bool far = false);

// ---- The camera --------------------------------------------------------------------------------

/// Moves the camera; nullopt shows the whole frame. Adds a camera undo step, except for motion
/// while the camera is held.
void move_camera(State& state,
                 const std::optional<render::Camera>& camera,
                 Facing facing = Facing::home);
/// Returns to the frame's default view when world coordinates have changed.
void forget_cameras(State& state);

// ---- The document ------------------------------------------------------------------------------

/// Shows the nearest existing frame and drops the previous frame's data.
void show_frame(State& state, int frame);
/// Advances to the next frame when this one has been shown long enough; stops at the last.
void play_frames(State& state, double seconds);
/// The current location as a bookmark without a name.
Bookmark bookmark_here(const State& state);
/// Throws Error, leaving the state unchanged, if the recording has no such frame.
void go_to_bookmark(State& state, const Bookmark& bookmark);
std::string frame_name(const Bookmark& bookmark);  // "frame 3" or, if it is gone, "a removed frame"
/// Sets new options as a separate undo step.
void change_options(State& state, const planes::PipelineOptions& after);
/// Reads the picked gravity of a recording being opened. An unusable file is reported and ignored.
void read_picked(State& state, OpenRecording& open);
/// Stores the picked gravity of an open recording in its label folder and in the document. If it
/// cannot be written, throws Error and changes nothing.
void keep_picked(State& state,
                 const std::filesystem::path& recording,
                 const io::PickedGravity& picked);

// ---- Labels ------------------------------------------------------------------------------------

/// Saves labels and returns to the debugger.
void leave_label_mode(State& state);
/// Drops uncommitted drawings on the frame.
void let_go(LabelView& view);
/// Commits an undo step to the journal and shows it. Throws Error if the frame is not ready or the
/// folder is read-only.
void commit_labels(State& state, const labels::LabelEdit& edit);
/// The same for a draft of the frame's labels, after fitting its planes.
labels::LabelEdit commit_labels(State& state, const std::string& title, labels::LabelDraft& draft);
/// Opens the label folder of the current recording. Throws Error if it is unusable.
void open_labels(State& state);
/// Writes modified label files. Throws Error on failure.
void save_labels(State& state);
/// The same when leaving must not be blocked: a failure is only reported, because the journal has
/// everything.
void save_labels_if_possible(State& state);

// ---- Status bar --------------------------------------------------------------------------------

void say(State& state, std::string message, bool is_error = false);
/// Suggests a next action until `done` returns true.
void say_hint(State& state, std::string hint, std::function<bool(const State&)> done);
/// Removes a hint that is done.
void drop_done_hint(State& state);
/// Explains why nothing changed; scripts print it to stderr.
void say_nothing_done(State& state, std::string why, bool is_error = false);

}  // namespace planescope::desktop
