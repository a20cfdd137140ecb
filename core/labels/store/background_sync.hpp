#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/model/file_bytes.hpp"

namespace planescope::labels {

/// Makes what was written to a file survive a loss of power, without the writer waiting for it.
class BackgroundSync {
 public:
  /// Takes a descriptor of its own.
  explicit BackgroundSync(const FileDescriptor& file);

  /// As soon as possible; requests that arrive in the meantime are combined.
  void request();
  /// The errno of the first request that failed, reported once, as the system does; 0: none failed.
  int take_error() { return error_.exchange(0); }

 private:
  void loop(std::stop_token stop);

  FileDescriptor file_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool wanted_ = false;
  std::atomic<int> error_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace planescope::labels
