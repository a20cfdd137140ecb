// Morton codes and their radix sort.

#include "core/model/morton.hpp"

#include <numeric>

namespace planescope {
namespace {

std::uint64_t gather(std::uint64_t x) {
  x &= 0x1249249249249249;
  x = (x | x >> 2) & 0x10c30c30c30c30c3;
  x = (x | x >> 4) & 0x100f00f00f00f00f;
  x = (x | x >> 8) & 0x1f0000ff0000ff;
  x = (x | x >> 16) & 0x1f00000000ffff;
  return (x | x >> 32) & 0x1fffff;
}

}  // namespace

std::array<std::uint32_t, 3> morton_cell(std::uint64_t code) {
  return {static_cast<std::uint32_t>(gather(code)), static_cast<std::uint32_t>(gather(code >> 1)),
          static_cast<std::uint32_t>(gather(code >> 2))};
}

// Radix sort, least significant digit first.
void sort_codes(std::vector<std::uint64_t>& codes, std::vector<std::uint32_t>& order, int bits) {
  constexpr int kDigitBits = 11;
  constexpr std::uint64_t kMask = (1 << kDigitBits) - 1;
  const int digits = (bits + kDigitBits - 1) / kDigitBits;
  order.resize(codes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::array<std::uint32_t, kMask + 1>> starts(static_cast<std::size_t>(digits));
  for (const std::uint64_t code : codes)
    for (int digit = 0; digit < digits; ++digit)
      ++starts[digit][code >> digit * kDigitBits & kMask];
  std::vector<std::uint64_t> sorted_codes(codes.size());
  std::vector<std::uint32_t> sorted_order(codes.size());
  for (int digit = 0; digit < digits; ++digit) {
    const int shift = digit * kDigitBits;
    auto& start = starts[digit];
    if (!codes.empty() && start[codes[0] >> shift & kMask] == codes.size()) continue;
    std::exclusive_scan(start.begin(), start.end(), start.begin(), 0U);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const std::uint32_t to = start[codes[i] >> shift & kMask]++;
      sorted_codes[to] = codes[i];
      sorted_order[to] = order[i];
    }
    codes.swap(sorted_codes);
    order.swap(sorted_order);
  }
}

}  // namespace planescope
