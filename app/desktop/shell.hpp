#pragma once

// The whole window: state, jobs, input and panels, whatever it is drawn to.

#include <memory>
#include <string>

#include "app/desktop/input.hpp"
#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/ui.hpp"

struct ImGuiContext;

namespace planescope::desktop {

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
  /// So that a script can tell whether its next step does something.
  void forget_nothing_done() { state_.view.did_nothing = false; }
  /// Something is left to show.
  bool needs_frame() const;
  /// Nothing is under way and nothing is left to show.
  bool idle(bool background = true) const { return !needs_frame() && !jobs_.busy(background); }
  ImGuiContext* context() const { return context_; }
  /// Where a picture of this frame is wanted, once; empty: nowhere.
  std::string take_picture_path();
  /// Tells what became of something outside of the state.
  void tell(const std::string& message, bool is_error) { say(state_, message, is_error); }
  /// The font atlas was made anew since the last call.
  bool take_fonts_changed();

  FrameTimes timing;  // shown by the action `timing`; whoever draws the frames measures them

 private:
  void draw(int width, int height);
  void rebuild_fonts(float scale);
  void note_scene_shape();

  State state_;
  Jobs jobs_;
  std::unique_ptr<Canvas> canvas_;
  InputQueue input_;
  Widgets widgets_;
  PanelMemory memory_;
  ImGuiContext* context_ = nullptr;
  float scale_ = 0;
  ImFont* small_ = nullptr;
  ImFont* bold_ = nullptr;
  int frames_to_draw_ = 3;
  bool fonts_changed_ = false;
};

}  // namespace planescope::desktop
