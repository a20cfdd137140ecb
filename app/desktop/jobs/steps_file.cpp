// Writes the animation of a run's steps in a background thread.

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <ostream>
#include <thread>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/jobs/jobs.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::desktop {

/// The writing thread and its short queue of pictures.
class StepsFile {
 public:
  StepsFile(const StepsSaving& saving, std::function<void()> wake)
      : path_(saving.path),
        count_(saving.count()),
        per_s_(saving.per_s),
        wake_(std::move(wake)),
        thread_([this](std::stop_token stop) { run(stop); }) {}

  struct Progress {
    int written = 0;       // pictures
    bool has_room = true;  // for another picture
    bool ended = false;
    std::string failure;  // why it ended early
  };
  Progress progress() const {
    constexpr std::size_t kMostWaiting = 2;
    const std::lock_guard lock(mutex_);
    return {written_, waiting_.size() < kMostWaiting, ended_, failure_};
  }
  void add(Image8 picture) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(picture));
    more_.notify_all();
  }

 private:
  void run(std::stop_token stop) {
    std::string failure;
    try {
      write_file_stream(path_, [&](std::ostream& out) { write(out, stop); });
    } catch (const std::exception& error) {
      failure = message_of(error);
    }
    {
      const std::lock_guard lock(mutex_);
      failure_ = failure;
      ended_ = true;
    }
    wake_();
  }

  void write(std::ostream& out, std::stop_token stop) {
    std::optional<io::ApngWriter> file;
    int width = 0, height = 0;
    for (int i = 0; i < count_; ++i) {
      std::unique_lock lock(mutex_);
      if (!more_.wait(lock, stop, [this] { return !waiting_.empty(); })) throw Cancelled();
      const Image8 picture = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      if (stop.stop_requested()) throw Cancelled();
      if (!file) {
        width = picture.width;
        height = picture.height;
        file.emplace(out, width, height, count_, per_s_, io::ApngStores::difference);
      }
      if (picture.width != width || picture.height != height)
        throw Error("steps not saved: the window was resized");
      file->add(picture);
      if (!out) return;  // disk full: reported by write_file_stream()
      lock.lock();
      ++written_;
      lock.unlock();
      wake_();
    }
    if (stop.stop_requested()) throw Cancelled();
    file->finish();
  }

  std::filesystem::path path_;
  int count_, per_s_;
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable_any more_;
  std::deque<Image8> waiting_;
  int written_ = 0;
  bool ended_ = false;
  std::string failure_;
  std::jthread thread_;  // last: it uses the members above
};

StepsSaver::StepsSaver(std::function<void()> wake) : wake_(std::move(wake)) {}
StepsSaver::~StepsSaver() = default;

bool StepsSaver::has_room() const {
  if (!file_) return true;
  const StepsFile::Progress now = file_->progress();
  return now.has_room || now.ended;
}

void StepsSaver::end(State& state, const std::string& message, bool is_error) {
  file_.reset();
  state.view.saving.reset();
  say(state, message, is_error);
}

bool StepsSaver::begin(State& state, bool still_at_work) {
  frames_without_ = 0;
  std::optional<StepsSaving>& saving = state.view.saving;
  if (!saving) {
    file_.reset();
    return false;
  }
  if (saving->cancelled) {
    end(state, "canceled: no steps saved", false);
    return false;
  }
  if (!file_) file_ = std::make_unique<StepsFile>(*saving, wake_);
  const StepsFile::Progress now = file_->progress();
  saving->written = now.written;
  if (now.ended) {
    const std::string written =
        fmt::format("{} written to {}", counted(static_cast<std::size_t>(saving->count()), "step"),
                    saving->path.string());
    end(state, now.failure.empty() ? written : now.failure, !now.failure.empty());
    return false;
  }
  const bool all = saving->taken == saving->count();
  if (!all && (!state.run() || saving->run.lock().get() != state.run())) {
    end(state, "steps not saved: the run has changed", true);
    return false;
  }
  if (all || still_at_work || !now.has_room) return false;
  state.view.playing.direction = 0;
  state.view.playing_frames = false;
  go_to_step(state, saving->step(saving->taken));
  saving->hidden = true;
  return true;
}

void StepsSaver::add(State& state, Image8 picture) {
  if (!state.view.saving || !file_) return;  // ended in the meantime
  state.view.saving->hidden = false;
  ++state.view.saving->taken;
  file_->add(std::move(picture));
}

void StepsSaver::note_frame(State& state) {
  constexpr int kMost = 10;
  if (state.view.saving && ++frames_without_ > kMost)
    end(state, "steps not saved: no renderer", true);
}

}  // namespace planescope::desktop
