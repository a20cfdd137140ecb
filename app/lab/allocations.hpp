#pragma once

// Counts what work allocates on the heap, by standing before the C library's functions in this
// program alone.

#include "core/lab/bench/chain_speed.hpp"

namespace planescope::app {

/// What `work` allocates on the calling thread: malloc and all that ends there, operator new too.
/// Growing a block counts as a new one. Empty where this build cannot count: under sanitizers,
/// which stand there themselves, and with other C libraries than glibc.
lab::CountAllocations allocation_counter();

}  // namespace planescope::app
