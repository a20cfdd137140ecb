#pragma once

// The whole window: state, jobs, input and panels, whatever it is drawn to.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/ui.hpp"

struct ImGuiContext;
struct ImGuiIO;

namespace planescope::desktop {

// Mouse and keys, from a window or from a script, in one queue. ImGui is told states, and so would
// lose taps that begin and end within a frame: each frame is handed only as much of the queue as
// changes no key or button twice.

/// Letters and digits are their ASCII capitals.
enum class Key : std::uint16_t {
  none = 0,
  space = ' ',
  left = 256,
  right,
  up,
  down,
  home,
  end,
  page_up,
  page_down,
  insert,
  del,
  backspace,
  enter,
  escape,
  tab,
  f1,
  f2,
  f3,
  f4,
  f5,
  f6,
  f7,
  f8,
  f9,
  f10,
  f11,
  f12,
  ctrl,
  shift,
  alt,
  count
};
/// "Right", "F5", "A"; nothing for a name no key has.
std::optional<Key> key_of_name(const std::string& name);
std::string name_of_key(Key key);

struct InputEvent {
  enum class Type : std::uint8_t { move, button, wheel, key, text };
  Type type = Type::move;
  float x = 0, y = 0;  // move: position; wheel: amounts
  int button = 0;      // 0 left, 1 right, 2 middle
  bool down = false;   // button, key
  Key key = Key::none;
  char32_t character = 0;  // text
};

class InputQueue {
 public:
  void push(const InputEvent& event) { events_.push_back(event); }
  bool empty() const { return events_.empty(); }
  /// Hands the next frame's events to ImGui. `shortcut` is called with "Ctrl+Shift+P" for each key
  /// that went down.
  template <typename Shortcut>
  void feed(ImGuiIO& io, const Shortcut& shortcut) {
    feed_events(io);
    for (const std::string& pressed : pressed_) shortcut(pressed);
    pressed_.clear();
  }
  /// ImGui's widgets do not see that the key went down in this frame.
  void let_go(ImGuiIO& io, Key key) const;

 private:
  void feed_events(ImGuiIO& io);
  std::deque<InputEvent> events_;
  std::deque<std::string> pressed_;
  bool ctrl_ = false, shift_ = false, alt_ = false;
};

/// Before the first event.
void expect_keys(ImGuiIO& io);

class Shell {
 public:
  /// `canvas` may be null. Makes an ImGui context of its own.
  Shell(State state, std::unique_ptr<Canvas> canvas, std::function<void()> wake);
  ~Shell();
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  const State& state() const { return state_; }
  const Widgets& widgets() const { return widgets_; }
  InputQueue& input() { return input_; }

  /// One frame: input, jobs, panels, commands. What is to be drawn is ImGui::GetDrawData() of
  /// context(). `seconds` since the last one.
  void frame(int width, int height, float screen_scale, double seconds);
  /// Applies a command as a key or a click would; errors go to the status bar unless `strict`.
  void perform(const Command& command, bool strict = false);
  /// A file or folder that was dropped on the window: a session, a report or a recording.
  void drop(const std::string& path, bool strict = false) {
    const bool document = std::filesystem::path(path).extension() == ".json";
    perform({document ? "session.open" : "recording.open", path}, strict);
  }
  /// So that a script can tell whether its next step does something.
  void forget_nothing_done() { state_.view.did_nothing = false; }
  /// Something is left to show.
  bool needs_frame() const;
  /// Nothing is under way and nothing is left to show.
  bool idle(bool background = true) const {
    return !needs_frame() && !jobs_.busy(background) && !steps_.active(state_);
  }
  ImGuiContext* context() const { return context_; }
  /// Where a picture of this frame is wanted, once; empty: nowhere.
  std::string take_picture_path();
  /// The next of the steps that are being saved is to be drawn, until it rests, and read.
  bool begin_step() { return steps_.begin(state_, jobs_.busy(false)); }
  void add_step(Image8 picture) { steps_.add(state_, std::move(picture)); }
  /// Tells what became of something outside of the state.
  void tell(const std::string& message, bool is_error) { say(state_, message, is_error); }
  /// The font atlas was made anew since the last call.
  bool take_fonts_changed();

  /// Drops a message that has been shown for some seconds; true as long as one is waited for.
  /// Errors stay until the next message.
  bool expire_message();

  FrameTimes timing;  // shown by the action `timing`; whoever draws the frames measures them

 private:
  void draw(int width, int height);
  void rebuild_fonts(float scale);
  void note_scene_shape();

  State state_;
  Jobs jobs_;
  StepsSaver steps_;
  std::unique_ptr<Canvas> canvas_;
  InputQueue input_;
  Widgets widgets_;
  PanelMemory memory_;
  ImGuiContext* context_ = nullptr;
  float scale_ = 0;
  ImFont* small_ = nullptr;
  ImFont* bold_ = nullptr;
  int frames_to_draw_ = 3;
  std::string picture_due_;
  bool fonts_changed_ = false;
  std::string message_;  // the one that was shown last ...
  std::chrono::steady_clock::time_point message_since_;
};

}  // namespace planescope::desktop
