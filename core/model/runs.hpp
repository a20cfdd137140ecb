#pragma once

// Where equal neighbours end: in the label images of planes, nearly all of them are equal.

#include <cstddef>
#include <cstdint>
#include <span>

namespace planescope {

/// The first index behind `begin` at which there is another value than there; values.size() where
/// there is none.
inline std::size_t end_of_run(std::span<const std::int32_t> values, std::size_t begin) {
  constexpr std::size_t kAtOnce = 8;
  const std::int32_t value = values[begin];
  std::size_t i = begin + 1;
  for (; i + kAtOnce <= values.size(); i += kAtOnce) {
    std::int32_t difference = 0;
    for (std::size_t k = 0; k < kAtOnce; ++k) difference |= values[i + k] ^ value;
    if (difference != 0) break;
  }
  while (i < values.size() && values[i] == value) ++i;
  return i;
}

}  // namespace planescope
