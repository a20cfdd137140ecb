#pragma once

// The whole window, independent of the drawing surface: state, jobs, input and panels.

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

// Mouse and key events from a window or a script, in one queue. ImGui only sees states and would
// miss a tap that begins and ends within a frame, so each frame receives events only until a key or
// button would change twice.

/// Letters and digits are their uppercase ASCII codes.
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
/// Parses "Right", "F5", "A"; nullopt for an unknown name.
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
  /// Passes the next frame's events to ImGui. Calls `shortcut` with, e.g., "Ctrl+Shift+P" for each
  /// pressed key.
  template <typename Shortcut>
  void feed(ImGuiIO& io, const Shortcut& shortcut) {
    feed_events(io);
    for (const std::string& pressed : pressed_) shortcut(pressed);
    pressed_.clear();
  }
  /// Hides this frame's key press from ImGui's widgets.
  void let_go(ImGuiIO& io, Key key) const;

 private:
  void feed_events(ImGuiIO& io);
  std::deque<InputEvent> events_;
  std::deque<std::string> pressed_;
  bool ctrl_ = false, shift_ = false, alt_ = false;
};

/// Call before the first event.
void expect_keys(ImGuiIO& io);

class Shell {
 public:
  /// `canvas` may be null. Creates its own ImGui context.
  Shell(State state, std::unique_ptr<Canvas> canvas, std::function<void()> wake);
  ~Shell();
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  const State& state() const { return state_; }
  const Widgets& widgets() const { return widgets_; }
  InputQueue& input() { return input_; }

  /// Runs one frame: input, jobs, panels, commands. The result is ImGui::GetDrawData() of
  /// context(). `seconds` is the time since the last frame.
  void frame(int width, int height, float screen_scale, double seconds);
  /// Applies a command like a key or a click; errors go to the status bar unless `strict`.
  void perform(const Command& command, bool strict = false);
  /// Opens a dropped file or folder: a session, a report or a recording.
  void drop(const std::string& path, bool strict = false) {
    const bool document = std::filesystem::path(path).extension() == ".json";
    perform({document ? "session.open" : "recording.open", path}, strict);
  }
  /// Lets a script detect whether its next step does anything.
  void forget_nothing_done() { state_.view.did_nothing = false; }
  /// Whether there is something new to draw.
  bool needs_frame() const;
  /// Whether no work is running and nothing is left to draw.
  bool idle(bool background = true) const {
    return !needs_frame() && !jobs_.busy(background) && !steps_.active(state_);
  }
  ImGuiContext* context() const { return context_; }
  /// Returns, once, the path to which a picture of this frame should be written; otherwise empty.
  std::string take_picture_path();
  /// Whether steps are being saved: the next one must be drawn until it settles, then passed to
  /// add_step().
  bool begin_step() { return steps_.begin(state_, jobs_.busy(false)); }
  void add_step(Image8 picture) { steps_.add(state_, std::move(picture)); }
  /// Shows a message about something outside of the state.
  void show_message(const std::string& message, bool is_error) { say(state_, message, is_error); }
  /// Whether the font atlas was rebuilt since the last call.
  bool take_fonts_changed();

  /// Clears a message after some seconds; returns true while one is pending. Errors stay until the
  /// next message.
  bool expire_message();

  FrameTimes timing;  // shown by the action `timing`; measured by the caller of frame()

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
  std::string message_;  // the last shown message ...
  std::chrono::steady_clock::time_point message_since_;
};

}  // namespace planescope::desktop
