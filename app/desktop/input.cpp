// Keyboard and mouse input: key names and the event queue that feeds ImGui.

#include <array>
#include <cctype>
#include <set>

#include "app/desktop/imgui.hpp"
#include "app/desktop/shell.hpp"

namespace planescope::desktop {
namespace {

constexpr std::array<std::pair<Key, const char*>, 30> kNames = {{
    {Key::space, "Space"},   {Key::left, "Left"},      {Key::right, "Right"},
    {Key::up, "Up"},         {Key::down, "Down"},      {Key::home, "Home"},
    {Key::end, "End"},       {Key::page_up, "PageUp"}, {Key::page_down, "PageDown"},
    {Key::insert, "Insert"}, {Key::del, "Delete"},     {Key::backspace, "Backspace"},
    {Key::enter, "Enter"},   {Key::escape, "Escape"},  {Key::tab, "Tab"},
    {Key::f1, "F1"},         {Key::f2, "F2"},          {Key::f3, "F3"},
    {Key::f4, "F4"},         {Key::f5, "F5"},          {Key::f6, "F6"},
    {Key::f7, "F7"},         {Key::f8, "F8"},          {Key::f9, "F9"},
    {Key::f10, "F10"},       {Key::f11, "F11"},        {Key::f12, "F12"},
    {Key::ctrl, "Ctrl"},     {Key::shift, "Shift"},    {Key::alt, "Alt"},
}};

int index_of(Key key) { return static_cast<int>(key); }

/// Keys used by ImGui's own widgets.
constexpr std::pair<Key, ImGuiKey> kImguiKeys[] = {
    {Key::tab, ImGuiKey_Tab},
    {Key::left, ImGuiKey_LeftArrow},
    {Key::right, ImGuiKey_RightArrow},
    {Key::up, ImGuiKey_UpArrow},
    {Key::down, ImGuiKey_DownArrow},
    {Key::page_up, ImGuiKey_PageUp},
    {Key::page_down, ImGuiKey_PageDown},
    {Key::home, ImGuiKey_Home},
    {Key::end, ImGuiKey_End},
    {Key::insert, ImGuiKey_Insert},
    {Key::del, ImGuiKey_Delete},
    {Key::backspace, ImGuiKey_Backspace},
    {Key::space, ImGuiKey_Space},
    {Key::enter, ImGuiKey_Enter},
    {Key::escape, ImGuiKey_Escape},
    {static_cast<Key>('A'), ImGuiKey_A},
    {static_cast<Key>('C'), ImGuiKey_C},
    {static_cast<Key>('V'), ImGuiKey_V},
    {static_cast<Key>('X'), ImGuiKey_X},
    {static_cast<Key>('Y'), ImGuiKey_Y},
    {static_cast<Key>('Z'), ImGuiKey_Z},
};

#if IMGUI_VERSION_NUM >= 18700
void set_key(ImGuiIO& io, Key key, bool down) {
  if (key == Key::ctrl) io.AddKeyEvent(ImGuiMod_Ctrl, down);
  if (key == Key::shift) io.AddKeyEvent(ImGuiMod_Shift, down);
  if (key == Key::alt) io.AddKeyEvent(ImGuiMod_Alt, down);
  for (const auto& [ours, theirs] : kImguiKeys)
    if (ours == key) io.AddKeyEvent(theirs, down);
}
#else
void set_key(ImGuiIO& io, Key key, bool down) {
  io.KeysDown[index_of(key)] = down;
  io.KeyCtrl = io.KeysDown[index_of(Key::ctrl)];
  io.KeyShift = io.KeysDown[index_of(Key::shift)];
  io.KeyAlt = io.KeysDown[index_of(Key::alt)];
}
#endif

}  // namespace

std::optional<Key> key_of_name(const std::string& name) {
  for (const auto& [key, text] : kNames)
    if (name == text) return key;
  if (name.size() == 1 && name[0] > ' ' && name[0] < 127)
    return static_cast<Key>(std::toupper(static_cast<unsigned char>(name[0])));
  return std::nullopt;
}

std::string name_of_key(Key key) {
  for (const auto& [known, text] : kNames)
    if (key == known) return text;
  return std::string(1, static_cast<char>(key));
}

void expect_keys(ImGuiIO& io) {
#if IMGUI_VERSION_NUM >= 18700
  io.ConfigInputTrickleEventQueue = false;  // the queue does this itself
#else
  for (const auto& [ours, theirs] : kImguiKeys) io.KeyMap[theirs] = index_of(ours);
#endif
}

void InputQueue::let_go(ImGuiIO& io, Key key) const { set_key(io, key, false); }

void InputQueue::feed_events(ImGuiIO& io) {
  std::set<int> touched;  // keys; buttons start at 1000
  bool moved = false, clicked = false;
  while (!events_.empty()) {
    const InputEvent event = events_.front();
    if (event.type == InputEvent::Type::move) {
      if (clicked) return;  // a drag starts where the button was pressed
      io.MousePos = ImVec2(event.x, event.y);
      moved = true;
    } else if (event.type == InputEvent::Type::button) {
      if (moved) return;  // the item under the mouse is only known in the next frame
      if (!touched.insert(1000 + event.button).second) return;
      io.MouseDown[event.button] = event.down;
      clicked = true;
    } else if (event.type == InputEvent::Type::wheel) {
      io.MouseWheelH += event.x;
      io.MouseWheel += event.y;
    } else if (event.type == InputEvent::Type::text) {
      io.AddInputCharacter(static_cast<unsigned>(event.character));
      if (event.character == U'?') pressed_.push_back("?");  // independent of the keyboard layout
    } else {
      if (!touched.insert(index_of(event.key)).second) return;
      set_key(io, event.key, event.down);
      if (event.key == Key::ctrl)
        ctrl_ = event.down;
      else if (event.key == Key::shift)
        shift_ = event.down;
      else if (event.key == Key::alt)
        alt_ = event.down;
      else if (event.down)
        pressed_.push_back(std::string(ctrl_ ? "Ctrl+" : "") + (shift_ ? "Shift+" : "") +
                           (alt_ ? "Alt+" : "") + name_of_key(event.key));
    }
    events_.pop_front();
  }
}

}  // namespace planescope::desktop
