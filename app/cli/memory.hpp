#pragma once

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace planescope::app {

/// From here on memory that is freed stays with this process, for commands that need as much again
/// for the next frame. Otherwise a frame's megabytes are handed back and mapped anew each time: a
/// tenth of all CPU time went into clearing their pages.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

}  // namespace planescope::app
