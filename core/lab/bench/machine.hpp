#pragma once

#include <string>

#include "core/model/simd.hpp"

namespace planescope::lab {

/// What timings were measured on.
struct Machine {
  std::string cpu;  // as the kernel names it, "unknown" where it does not
  int cores = 1;    // that the program may use
  Simd simd = Simd::plain;
};
Machine this_machine();

}  // namespace planescope::lab
