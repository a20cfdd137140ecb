#pragma once

// Assertion that a text contains a part, with both in the failure message.

#include <gtest/gtest.h>

#include <string>

namespace planescope {

/// Whether `text` contains `part`; the failure message shows both.
inline testing::AssertionResult has(const std::string& text, const std::string& part) {
  const bool holds = text.find(part) != std::string::npos;
  return (holds ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "'" << part << "' in: " << text;
}

}  // namespace planescope
