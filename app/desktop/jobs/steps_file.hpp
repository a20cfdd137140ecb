#pragma once

// Pictures of steps, written into an animated PNG while the window goes on: it draws one step after
// the other, a thread packs and writes them. The file is there once it is whole, and not before.

#include <functional>
#include <memory>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

class StepsFile;

class StepsSaver {
 public:
  /// `wake`: called from another thread whenever a picture was written.
  explicit StepsSaver(std::function<void()> wake);
  ~StepsSaver();  // what is not whole is not left behind

  /// The next step is in the state, to be drawn and handed to add(). False where none is wanted or
  /// there is no room for it yet. Says what became of the file once that is known.
  bool begin(State& state, bool still_at_work);
  void add(State& state, Image8 picture);
  /// Pictures are wanted, or being written.
  bool active(const State& state) const { return state.view.saving || file_; }
  bool has_room() const;
  /// Called for each frame that is drawn: where none of them takes pictures, the file is given up.
  void note_frame(State& state);

 private:
  void end(State& state, const std::string& message, bool is_error);

  std::function<void()> wake_;
  std::unique_ptr<StepsFile> file_;
  int frames_without_ = 0;
};

}  // namespace planescope::desktop
