#pragma once

// Error messages of calls that must fail.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/model/error.hpp"

namespace planescope {

/// Message of the Error that an action throws; empty if it throws none.
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Expects a message of one line that contains `part`.
inline void expect_refused(const std::function<void()>& action, const std::string& part) {
  const std::string message = message_of(action);
  EXPECT_NE(message.find(part), std::string::npos) << "said: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

}  // namespace planescope
