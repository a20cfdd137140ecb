#pragma once

// Scripted actions and input: {"actions": [...]}, each of
//   "step.next"                                    an action by name, "filter.set case==III" with
//   {"do": "filter.set", "with": "case==III"}      its argument
//   {"click": "octree.node.12"}                    a widget by name; "button": "right", "double":
//                                                  true, "hold": "Shift", "at": [0.5, 0.5]
//   {"drag": "timeline", "from": [0, 0.5], "to": [1, 0.5]}   shares of the widget, or "by": [dx,
//   dy]
//   {"hover": "image"}, {"wheel": "view3d", "by": 2}
//   {"key": "Ctrl+P"}, {"type": "merge"}
//   {"drop": "recording.bag"}                      a file that is dropped on the window
//   {"screenshot": "a.png"}, {"state": "a.json"}   the picture with "of": "view3d" of a widget
//   alone
//   {"expect": {"step": 12}}                       facts of state_facts(); otherwise exit code 1
// After each, everything that is under way comes to rest, unless it says "wait": false.
// docs/desktop.md documents it.

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>

#include "app/desktop/shell.hpp"

namespace planescope::desktop {

/// An "expect" that did not hold.
struct ExpectationFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Where a script's frames are drawn.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual void draw_frame() = 0;  // one frame of the shell, a sixtieth of a second later
  /// What the last frame shows. RGB, row 0 at the top.
  virtual Image8 picture() = 0;
  /// Of the whole window, or of a part of it.
  void screenshot(const std::filesystem::path& path, const std::optional<WidgetRect>& part = {});
};

/// Writes the picture that an action asked for, if one did.
void take_picture(Shell& shell, Stage& stage);
/// Hands over the next of the steps that are being saved, drawn until it rests, if one is wanted.
void take_step(Shell& shell,
               const std::function<void()>& draw,
               const std::function<Image8()>& picture);

class Script {
 public:
  /// Throws Error naming the file and the action that cannot be understood.
  static Script read(const std::filesystem::path& path);
  /// Of one action; `from`: what is named where it fails.
  static Script of(const std::string& action, const std::string& with, const std::string& from);
  /// Throws as the actions do, Error naming the place in the script; ExpectationFailed. Only a
  /// screenshot, a state and an expectation that does not hold yet wait for background work.
  void play(Shell& shell, Stage& stage, std::stop_token stop) const;

 private:
  std::filesystem::path path_;
  std::shared_ptr<const nlohmann::ordered_json> actions_;
};

/// Draws frames until nothing is under way, as Jobs::busy() has it. Throws Cancelled when stopped.
void settle(Shell& shell, Stage& stage, std::stop_token stop, bool background = true);

}  // namespace planescope::desktop
