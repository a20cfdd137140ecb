// Counts heap allocations by interposing the C library's allocation functions in this program.

#include <cerrno>
#include <cstdlib>

#include "app/lab/lab.hpp"

// No other file may define these functions, and nothing in this file may allocate.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PLANESCOPE_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define PLANESCOPE_COUNTS_ALLOCATIONS 0
#endif
#endif
#if !defined(PLANESCOPE_COUNTS_ALLOCATIONS)
#if defined(__GLIBC__)
#define PLANESCOPE_COUNTS_ALLOCATIONS 1
#else
#define PLANESCOPE_COUNTS_ALLOCATIONS 0
#endif
#endif

#if PLANESCOPE_COUNTS_ALLOCATIONS

namespace {

// Per thread, so that other threads do not count and nothing is shared.
thread_local bool counting = false;
thread_local planescope::lab::Allocations allocated;

void count_allocation(std::size_t bytes) {
  if (!counting) return;
  ++allocated.calls;
  allocated.bytes += bytes;
}

}  // namespace

// Blocks come from glibc's own allocator, so its free() accepts them.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) noexcept {
  count_allocation(bytes);
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) noexcept {
  count_allocation(count * bytes);
  return __libc_calloc(count, bytes);
}

void* realloc(void* block, std::size_t bytes) noexcept {
  count_allocation(bytes);
  return __libc_realloc(block, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  count_allocation(bytes);
  return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0)
    return EINVAL;
  count_allocation(bytes);
  void* const made = __libc_memalign(alignment, bytes);
  if (!made) return ENOMEM;
  *block = made;
  return 0;
}
}

#endif

namespace planescope::app {

lab::CountAllocations allocation_counter() {
#if PLANESCOPE_COUNTS_ALLOCATIONS
  return [](const std::function<void()>& work) {
    allocated = {};
    counting = true;
    try {
      work();
    } catch (...) {
      counting = false;
      throw;
    }
    counting = false;
    return allocated;
  };
#else
  return {};
#endif
}

}  // namespace planescope::app
