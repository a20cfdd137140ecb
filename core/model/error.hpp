#pragma once

// The one exception type for errors of the outside world: files, options, devices.

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "core/model/text.hpp"

namespace planescope {

/// An error outside of the program: in a file, weights, GL, an option. The message is one line that
/// names the file or option, what was found and what was expected. `main` catches it once, prints
/// it and exits with 2. Programmer mistakes are asserts, normal absences std::optional.
struct Error : std::runtime_error {
  /// What names in files may hold besides text cannot make more than one line of it.
  explicit Error(const std::string& message) : std::runtime_error(one_line(message)) {}
};

/// Long work was stopped on request (exit code 130).
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

/// What a person is told of it: std::bad_alloc would tell the name of a class.
inline std::string message_of(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) ? "out of memory" : error.what();
}

}  // namespace planescope
