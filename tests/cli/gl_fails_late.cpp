// In front of libOpenGL's function of this name: all is well for the first frame's pictures, then
// the driver runs out of memory.

#include <atomic>

extern "C" unsigned glGetError() {
  constexpr int kCallsThatSucceed = 15;
  constexpr unsigned kOutOfMemory = 0x0505;
  static std::atomic<int> calls = 0;
  const int call = ++calls;
  return call > kCallsThatSucceed && call % 2 == 0 ? kOutOfMemory : 0;
}
