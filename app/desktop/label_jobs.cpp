#include "app/desktop/label_jobs.hpp"

#include "app/desktop/actions.hpp"
#include "core/base/error.hpp"

namespace planescope::desktop {
namespace {

std::shared_ptr<const LabelFrame> make_label_frame(std::shared_ptr<const Recording> recording,
                                                   const Subject& subject) {
  auto made = std::make_shared<LabelFrame>();
  made->frame = subject.frame.index;
  made->sha256 = recording->frame_hash(made->frame);
  made->grid = make_label_grid(subject.frame, subject.prepared.gravity);
  made->T_world_sensor = subject.prepared.cloud.T_world_sensor;
  const Eigen::Isometry3f T = made->T_world_sensor.cast<float>();
  made->world.reserve(made->grid.pixels());
  for (const Vec3f& point : made->grid.points) made->world.push_back(T * point);
  made->recording = std::move(recording);
  return made;
}

/// The store may refuse what is there; the frame is shown all the same.
void take_in(State& state, std::shared_ptr<const LabelFrame> made) {
  const OpenRecording* open = state.document.current();
  if (!open || open->recording != made->recording || state.document.frame != made->frame) return;
  LabelResults& label = state.results.label;
  label.refusal.clear();
  try {
    if (open->labels) open->labels->open(made->frame, empty_labels(made->grid, made->sha256));
    label.frame = std::move(made);
  } catch (const std::exception& error) {
    label.frame = nullptr;
    label.refusal = error.what();
  }
}

}  // namespace

LabelJobs::LabelJobs(std::function<void(std::function<void(State&)>)> deliver,
                     std::function<void()> wake)
    : deliver_(std::move(deliver)), frames_(std::move(wake)) {}

LabelJobs::~LabelJobs() { frames_.cancel(); }

void LabelJobs::pursue_frame(State& state) {
  const RunView* view = state.run_view();
  if (!view) return;  // its refusal is shown
  const std::shared_ptr<const Subject>& subject = view->run->subject;
  const std::shared_ptr<const Recording>& recording = state.document.current()->recording;
  const Vec3d& gravity = subject->prepared.gravity.direction;
  if (subject->frame.index != state.document.frame) return;
  if (recording == recording_ && state.document.frame == frame_ && gravity == gravity_) return;
  recording_ = recording;
  frame_ = state.document.frame;
  gravity_ = gravity;
  state.results.label.refusal.clear();
  frames_.replace([this, recording, subject](std::stop_token) {
    try {
      deliver_([made = make_label_frame(recording, *subject)](State& s) { take_in(s, made); });
    } catch (const std::exception& error) {
      deliver_([message = std::string(error.what())](State& s) {
        s.results.label.frame = nullptr;
        s.results.label.refusal = message;
      });
    }
  });
}

void LabelJobs::pursue(State& state) {
  if (state.view.mode != Mode::labels || !state.document.current()) return;
  pursue_frame(state);
}

bool LabelJobs::busy() const { return frames_.busy(); }

}  // namespace planescope::desktop
