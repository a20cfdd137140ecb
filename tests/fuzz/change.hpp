#pragma once

// Changed files: bytes changed anywhere, or one piece of a file that is written anew around it.

#include <functional>
#include <random>

#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {

/// Changes bytes anywhere, to at most `max` of them.
using ChangeBytes = std::function<void(ByteVector& bytes, std::size_t max)>;

/// One piece of the file changed, left out, doubled or moved. Empty where its pieces cannot be told
/// or do not fit.
ByteVector with_changed_piece(const Target& target,
                              Bytes bytes,
                              std::size_t max,
                              std::minstd_rand& random,
                              const ChangeBytes& change_bytes);

/// A few changes of the kinds that files suffer: bits, numbers at their ends, parts that are cut,
/// doubled or overwritten. By `random` alone.
void change_at_random(ByteVector& bytes, std::size_t max, std::minstd_rand& random);

}  // namespace planescope::fuzz
