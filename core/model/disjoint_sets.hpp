#pragma once

// Disjoint sets, and runs of equal values.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace planescope {

/// Disjoint sets of 0 .. n - 1 (union-find with path halving). The root of a set is its
/// smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::size_t size() const { return parent_.size(); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Tracks which region each merged region belongs to; the caller chooses the root of a merge.
class Roots {
 public:
  explicit Roots(std::size_t count) : into_(count) { std::iota(into_.begin(), into_.end(), 0); }
  std::int32_t root(std::int32_t k) {
    while (into_[k] != k) k = into_[k] = into_[into_[k]];
    return k;
  }
  void join_into(std::int32_t from, std::int32_t into) { into_[from] = into; }
  /// Replaces every region by its root; negative values are unchanged.
  void apply_to(std::vector<std::int32_t>& regions) {
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(into_.size()); ++k) into_[k] = root(k);
    for (std::int32_t& region : regions)
      if (region >= 0) region = into_[region];
  }

 private:
  std::vector<std::int32_t> into_;
};

}  // namespace planescope

// Ends of runs of equal values, optimized for the long runs in label images.

namespace planescope {

/// The first index after `begin` with a different value; values.size() if there is none.
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
