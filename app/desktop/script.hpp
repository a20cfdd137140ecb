#pragma once

// Scripted actions and input: {"actions": [...]}, each one of
//   "step.next"                                    an action by name, or "filter.set case==III"
//                                                  with its argument
//   {"do": "filter.set", "with": "case==III"}      the same as an object
//   {"click": "octree.node.12"}                    a widget by name; "button": "right", "double":
//                                                  true, "hold": "Shift", "at": [0.5, 0.5]
//   {"drag": "timeline", "from": [0, 0.5], "to": [1, 0.5]}   fractions of the widget, or "by":
//                                                  [dx, dy]
//   {"hover": "image"}, {"wheel": "view3d", "by": 2}
//   {"key": "Ctrl+P"}, {"type": "merge"}
//   {"drop": "recording.bag"}                      a file dropped on the window
//   {"screenshot": "a.png"}, {"state": "a.json"}   "of": "view3d" limits the picture to a widget
//   {"expect": {"step": 12}}                       facts of state_facts(); exit code 1 on failure
// After each action, the player waits for all work to finish unless it has "wait": false. See
// docs/desktop.md.

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>

#include "app/desktop/shell.hpp"

namespace planescope::desktop {

/// Thrown when an "expect" fails.
struct ExpectationFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Draws a script's frames.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual void draw_frame() = 0;  // draws one frame, a sixtieth of a second after the last
  /// The last frame. RGB, row 0 at the top.
  virtual Image8 picture() = 0;
  /// Writes a picture of the whole window or of `part`.
  void screenshot(const std::filesystem::path& path, const std::optional<WidgetRect>& part = {});
};

/// Writes the picture requested by an action, if any.
void take_picture(Shell& shell, Stage& stage);
/// If steps are being saved, draws the next one until it settles and hands over its picture.
void take_step(Shell& shell,
               const std::function<void()>& draw,
               const std::function<Image8()>& picture);

class Script {
 public:
  /// Throws Error with the file and the invalid action.
  static Script read(const std::filesystem::path& path);
  /// A script with one action; errors begin with `from`.
  static Script of(const std::string& action, const std::string& with, const std::string& from);
  /// Throws the errors of actions, prefixed with their location in the script, and
  /// ExpectationFailed. Only screenshots, states and failing expectations wait for background work.
  void play(Shell& shell, Stage& stage, std::stop_token stop) const;

 private:
  std::filesystem::path path_;
  std::shared_ptr<const nlohmann::ordered_json> actions_;
};

/// Draws frames until no work is left (see Jobs::busy()). Throws Cancelled on stop.
void settle(Shell& shell, Stage& stage, std::stop_token stop, bool background = true);

}  // namespace planescope::desktop
