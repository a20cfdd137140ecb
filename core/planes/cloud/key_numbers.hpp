#pragma once

// Numbers keys in the order in which they are first seen (open addressing).

#include <bit>
#include <cstdint>
#include <vector>

namespace planescope::planes {

/// Assigns 0, 1, 2, ... to 64-bit keys in order of first appearance. A flat hash (open
/// addressing, linear probing) whose slots contain only the numbers: small enough for the cache,
/// with few page faults.
class KeyNumbers {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// `expected`: number of keys that fit without growing.
  explicit KeyNumbers(std::size_t expected)
      : shift_(64 - std::countr_zero(std::bit_ceil(2 * expected + 2))),
        slots_(std::size_t{1} << (64 - shift_), kNone) {
    reserve();
  }

  std::uint32_t find_or_add(std::uint64_t key) {
    std::size_t i = home(key);
    for (; slots_[i] != kNone; i = (i + 1) & (slots_.size() - 1))
      if (keys_[slots_[i]] == key) return slots_[i];
    if (keys_.size() == keys_.capacity()) {
      grow();
      return find_or_add(key);
    }
    const auto number = static_cast<std::uint32_t>(keys_.size());
    slots_[i] = number;
    keys_.push_back(key);
    return number;
  }
  /// kNone if the key was never added.
  std::uint32_t find(std::uint64_t key) const {
    std::size_t i = home(key);
    while (slots_[i] != kNone && keys_[slots_[i]] != key) i = (i + 1) & (slots_.size() - 1);
    return slots_[i];
  }
  /// Prefetches the memory that a lookup of the key reads.
  void fetch(std::uint64_t key) const { __builtin_prefetch(&slots_[home(key)]); }
  const std::vector<std::uint64_t>& keys() const { return keys_; }  // by number

 private:
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> shift_);  // Fibonacci hashing
  }
  void reserve() { keys_.reserve(slots_.size() / 2); }  // until half of the slots are used
  void grow() {
    --shift_;
    slots_.assign(slots_.size() * 2, kNone);
    for (std::uint32_t number = 0; number < keys_.size(); ++number) {
      std::size_t i = home(keys_[number]);
      while (slots_[i] != kNone) i = (i + 1) & (slots_.size() - 1);
      slots_[i] = number;
    }
    reserve();
  }

  int shift_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint64_t> keys_;
};

}  // namespace planescope::planes
