#pragma once

// Mouse and keys, from a window or from a script, in one queue. ImGui is told states, and so would
// lose taps that begin and end within a frame: each frame is handed only as much of the queue as
// changes no key or button twice.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

struct ImGuiIO;

namespace planescope::desktop {

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

}  // namespace planescope::desktop
