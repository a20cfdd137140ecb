#pragma once

#include <cstddef>
#include <functional>

namespace planescope {

/// Calls body(begin, end) on consecutive chunks that cover [0, count), on up to `threads` threads.
/// The chunking depends on `threads`, so a body must write only what belongs to its own indices:
/// then the result is the same for any thread count. Exceptions of a body are rethrown here.
void parallel_for(std::size_t count,
                  int threads,
                  const std::function<void(std::size_t, std::size_t)>& body,
                  std::size_t min_chunk = 256);

}  // namespace planescope
