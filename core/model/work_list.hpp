#pragma once

#include <functional>

namespace planescope {

/// Calls body(i) once for every i of [0, count) on up to `threads` threads, whichever is free
/// taking the next: for pieces of work of unequal length. `progress(done, count)` is called on the
/// caller's thread; it may be empty and may throw to stop. Exceptions of a body stop the rest and
/// are rethrown here.
void work_through(int count,
                  int threads,
                  const std::function<void(int)>& body,
                  const std::function<void(int, int)>& progress = {});

/// As above, each thread with a body of its own, made on that thread and gone with it.
void work_through_with(int count,
                       int threads,
                       const std::function<std::function<void(int)>()>& make_body,
                       const std::function<void(int, int)>& progress = {});

}  // namespace planescope
