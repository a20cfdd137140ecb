#pragma once

// Every action by subject, the types of their arguments, and what several of them share.

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

/// An action with its argument: a value of the type that the action takes or, from outside the
/// program, text: "filter.set" with "case==III".
struct Command {
  std::string action;
  std::string argument = {};
  std::any value = {};
};

/// `value` as actions take it: whole numbers as int, other numbers as double, text as std::string,
/// everything else as it is.
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

/// In which mode an action and its key work. A key of one mode goes before one that works anywhere.
enum class KeyMode : std::uint8_t { anywhere, debugger, labels };

using Condition = std::function<bool(const State&)>;

struct Action {
  std::string name;   // "step.next"
  std::string title;  // "Step forward"
  std::string menu;   // "Step"; empty: in no menu
  std::string keys;   // "Right", "Shift+F5"; several separated by spaces; empty: none
  std::string takes;  // the argument, in brackets where it is optional; empty: none
  std::string words;  // that people look it up by besides title and name
  std::function<void(State&, const Command&)> run;
  Condition enabled;  // empty: always
  Condition checked;  // empty: not a switch
  KeyMode mode = KeyMode::anywhere;
  bool key_is_argument = false;  // "3" runs it with "3"

  bool can_run(const State& state) const { return !enabled || enabled(state); }
  bool is_on(const State& state) const { return checked && checked(state); }
};

const std::vector<Action>& action_table();
/// Throws Error naming the nearest existing action.
const Action& find_action(const std::string& name);
/// Whether a key or menu must ask for its argument first.
bool needs_argument(const Action& action);
/// Null where no action has this key ("Ctrl+P") in that mode.
const Action* action_of_key(const std::string& key, Mode mode);
/// The action can be used in that mode.
bool fits(const Action& action, Mode mode);
/// The first of its keys, as menus show it; empty where it has none.
std::string first_key(const Action& action);

/// Changes the state. Throws Error on an unknown action or an invalid argument, the state
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

// ---- Arguments ---------------------------------------------------------------------------------

/// A type of argument: how lists show it, how it is read from text, and which values are valid now.
/// Both functions throw Error naming the action and what was expected.
template <typename T>
struct Takes {
  std::string text;  // "NODE"
  std::function<T(const State&, const std::string& action, const std::string& text)> read;
  std::function<void(const State&, const std::string& action, const T&)> check = {};
};

Takes<std::string> text(std::string shown);
Takes<double> number(std::string shown);
/// "U0,V0,U1,V1": as many numbers as the type holds.
template <std::size_t count>
Takes<std::array<double, count>> numbers(std::string shown);

struct Range {
  int low = 0, high = 0;
};
Takes<int> whole(std::string shown, std::function<Range(const State&)> range);
/// The index of an item of a list.
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
/// The same as an enumeration of that order.
template <typename Enum>
Takes<Enum> choice(std::string names) {
  return {names, [all = names_of(names)](const State&, const std::string& action,
                                         const std::string& text) {
            return static_cast<Enum>(choice_argument(action, text, all));
          }};
}

/// An argument with one text that means "none".
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
/// An argument that may be left out.
template <typename T>
Takes<std::optional<T>> maybe(Takes<T> takes) {
  takes.text = "[" + takes.text + "]";
  return or_none(std::move(takes), "");
}

// Text that several types are read from. All throw Error naming the action and what was expected.

int whole_argument(const std::string& action, const std::string& text, int low, int high);
/// "3" or "P3".
int plane_number_argument(const std::string& action, const std::string& text, int low, int high);
double number_argument(const std::string& action, const std::string& text);
/// "12.5,3,7" as exactly `count` numbers.
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

// ---- Tables of actions -------------------------------------------------------------------------

/// The value of a command. Throws where a panel hands over another type, which is a defect.
template <typename T>
T value_in(const std::any& value, const Takes<T>&) {
  return std::any_cast<T>(value);
}
template <typename T>
std::optional<T> value_in(const std::any& value, const Takes<std::optional<T>>&) {
  const T* given = std::any_cast<T>(&value);
  return given ? *given : std::any_cast<std::optional<T>>(value);
}

/// A row of a table, while it is being added.
class ActionRow {
 public:
  ActionRow(Action& action, std::string menu) : action_(action), menu_(std::move(menu)) {}

  /// In the table's menu, with these keys.
  ActionRow& key(std::string keys) {
    action_.keys = std::move(keys);
    return menu(menu_);
  }
  /// In the table's menu, without a key.
  ActionRow& menu() { return menu(menu_); }
  ActionRow& menu(std::string name) {
    action_.menu = std::move(name);
    return *this;
  }
  ActionRow& words(std::string more) {
    action_.words = std::move(more);
    return *this;
  }
  /// When it can run, in place of the table's condition.
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
  /// When the switch is on.
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
  /// A switch: runs by flipping a flag of the view, `&ViewState::marking` or what a generic
  /// function of the view returns.
  template <typename Flag>
  ActionRow& flips(Flag flag) {
    on([flag](const State& s) { return std::invoke(flag, s.view); });
    return run([flag](State& s) { std::invoke(flag, s.view) = !std::invoke(flag, s.view); });
  }

 private:
  Action& action_;
  std::string menu_;
};

/// Actions that share a menu, a mode and when they can run.
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
/// What points are colored by: the action that chooses it, by its key, and its name in lists.
struct ColorChoice {
  render::ColorBy by;
  const char *action, *title, *key, *name;
};
/// By render::ColorBy.
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
/// What all tools of the label mode do to slivers.
enum class SliverAction : std::uint8_t { show, keep, take, ignore };

/// Pixel v * width + u, or point of a cloud, of the selected point; nothing where none is selected.
std::optional<std::size_t> source_of(const Selection& selected, const debug::Subject& subject);
/// The switch of what a click in a view does.
ActionRow add_click(
    const ActionGroup& group, const char* name, const char* title, const char* key, Click what);
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
/// Every step at which one of the breakpoints that are enabled (or are not) stops, ascending.
std::vector<std::int32_t> breakpoint_steps(const debug::Run& run,
                                           const std::vector<Breakpoint>& all,
                                           bool enabled = true);
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
std::string frame_name(const Bookmark& bookmark);  // "frame 3" or, if it is gone, "a removed frame"
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
void commit_labels(State& state, const labels::LabelEdit& edit);
/// The same of a draft of the frame's labels, whose planes are fitted first.
labels::LabelEdit commit_labels(State& state, const std::string& title, labels::LabelDraft& draft);
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
