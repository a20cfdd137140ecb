#include "app/desktop/input.hpp"

#include <imgui.h>

#include <array>
#include <cctype>
#include <set>

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

bool is_modifier(Key key) { return key == Key::ctrl || key == Key::shift || key == Key::alt; }

std::string with_modifiers(const ImGuiIO& io, Key key) {
  return std::string(io.KeyCtrl ? "Ctrl+" : "") + (io.KeyShift ? "Shift+" : "") +
         (io.KeyAlt ? "Alt+" : "") + name_of_key(key);
}

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

void map_keys(ImGuiIO& io) {
  const std::pair<ImGuiKey, Key> map[] = {
      {ImGuiKey_Tab, Key::tab},
      {ImGuiKey_LeftArrow, Key::left},
      {ImGuiKey_RightArrow, Key::right},
      {ImGuiKey_UpArrow, Key::up},
      {ImGuiKey_DownArrow, Key::down},
      {ImGuiKey_PageUp, Key::page_up},
      {ImGuiKey_PageDown, Key::page_down},
      {ImGuiKey_Home, Key::home},
      {ImGuiKey_End, Key::end},
      {ImGuiKey_Insert, Key::insert},
      {ImGuiKey_Delete, Key::del},
      {ImGuiKey_Backspace, Key::backspace},
      {ImGuiKey_Space, Key::space},
      {ImGuiKey_Enter, Key::enter},
      {ImGuiKey_Escape, Key::escape},
      {ImGuiKey_A, static_cast<Key>('A')},
      {ImGuiKey_C, static_cast<Key>('C')},
      {ImGuiKey_V, static_cast<Key>('V')},
      {ImGuiKey_X, static_cast<Key>('X')},
      {ImGuiKey_Y, static_cast<Key>('Y')},
      {ImGuiKey_Z, static_cast<Key>('Z')},
  };
  for (const auto& [theirs, ours] : map) io.KeyMap[theirs] = index_of(ours);
}

void InputQueue::feed_events(ImGuiIO& io) {
  std::set<int> touched;  // keys and, from 1000 on, buttons
  bool moved = false, clicked = false;
  while (!events_.empty()) {
    const InputEvent event = events_.front();
    if (event.type == InputEvent::Type::move) {
      if (clicked) return;  // a drag begins where the button went down
      io.MousePos = ImVec2(event.x, event.y);
      moved = true;
    } else if (event.type == InputEvent::Type::button) {
      if (moved) return;  // what is under the mouse is known a frame later
      if (!touched.insert(1000 + event.button).second) return;
      io.MouseDown[event.button] = event.down;
      clicked = true;
    } else if (event.type == InputEvent::Type::wheel) {
      io.MouseWheelH += event.x;
      io.MouseWheel += event.y;
    } else if (event.type == InputEvent::Type::text) {
      io.AddInputCharacter(static_cast<unsigned>(event.character));
      if (event.character == U'?') pressed_.push_back("?");  // wherever a keyboard has it
    } else {
      if (!touched.insert(index_of(event.key)).second) return;
      io.KeysDown[index_of(event.key)] = event.down;
      io.KeyCtrl = io.KeysDown[index_of(Key::ctrl)];
      io.KeyShift = io.KeysDown[index_of(Key::shift)];
      io.KeyAlt = io.KeysDown[index_of(Key::alt)];
      if (event.down && !is_modifier(event.key)) pressed_.push_back(with_modifiers(io, event.key));
    }
    events_.pop_front();
  }
}

}  // namespace planescope::desktop
