#pragma once

// The exception type for external errors: files, options, devices.

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "core/model/text.hpp"

namespace planescope {

/// An error outside the program: in a file, weights, GL, an option. The message is one line naming
/// the file or option, what was found and what was expected. `main` catches it once, prints it and
/// exits with 2. Programmer mistakes are asserts; normal absences are std::optional.
struct Error : std::runtime_error {
  /// Control characters are replaced, so that file contents cannot break the message into
  /// several lines.
  explicit Error(const std::string& message) : std::runtime_error(one_line(message)) {}
};

/// Long work was canceled by the user (exit code 130).
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("canceled") {}
};

inline constexpr const char* kHowToNeedLessMemory =
    "use a larger --voxel (clouds), a smaller --max-range, fewer --frames, or fewer --threads";

/// Calls work(). If memory runs out, throws Error beginning with `what`.
template <typename Work>
decltype(auto) naming_memory(const std::string& what, Work&& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Error(what + ": out of memory; " + kHowToNeedLessMemory);
  }
}

/// User-visible message; std::bad_alloc::what() is only the name of a class.
inline std::string message_of(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) ? "out of memory" : error.what();
}

}  // namespace planescope
