#include "core/labels/store/background_sync.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace planescope::labels {

BackgroundSync::BackgroundSync(const FileDescriptor& file)
    : file_(::fcntl(file.get(), F_DUPFD_CLOEXEC, 0)),
      thread_([this](std::stop_token stop) { loop(stop); }) {}

void BackgroundSync::request() {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = true;
  }
  wake_.notify_one();
}

void BackgroundSync::loop(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  while (wake_.wait(lock, stop, [this] { return wanted_; })) {
    wanted_ = false;
    lock.unlock();
    if (int none = 0; ::fdatasync(file_.get()) != 0) error_.compare_exchange_strong(none, errno);
    lock.lock();
  }
}

}  // namespace planescope::labels
