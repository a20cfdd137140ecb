#include "core/classify/cell_table.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace planescope {

CellTable::CellTable(std::span<const std::uint64_t> codes, int level) : level_(level) {
  // The highest level, counted from 0, at which a cell begins with point i; -1 for none.
  const auto opens = [&](std::size_t i) {
    if (i == 0) return kZBits;
    const std::uint64_t differs = codes[i] ^ codes[i - 1];
    return differs ? (63 - std::countl_zero(differs)) / 3 : -1;
  };
  std::size_t cells = 0;
  for (std::size_t i = 0; i < codes.size(); ++i)
    cells += static_cast<std::size_t>(std::max(0, opens(i) - level + 1));
  const std::size_t capacity = std::bit_ceil(2 * cells + 1);
  shift_ = 64 - std::countr_zero(capacity);
  slots_.resize(capacity);

  std::array<std::uint32_t, kZBits + 1> begins{};  // of the cell that is open at each level
  const auto close = [&](std::size_t end, int up_to) {
    for (int l = level; l <= up_to; ++l) {
      insert(key(codes[begins[l]] >> 3 * l, l), {begins[l], static_cast<std::uint32_t>(end)});
      begins[l] = static_cast<std::uint32_t>(end);
    }
  };
  for (std::size_t i = 1; i < codes.size(); ++i) close(i, opens(i));
  if (!codes.empty()) close(codes.size(), kZBits);
}

void CellTable::insert(std::uint64_t key, Range range) {
  std::size_t i = home(key);
  while (slots_[i].key != 0) i = (i + 1) & (slots_.size() - 1);
  slots_[i] = {key, range};
}

CellTable::Range CellTable::find(std::span<const std::uint64_t> codes,
                                 std::uint64_t code,
                                 int level) const {
  if (level < level_) {
    const auto first_at = [&](std::uint64_t value) {
      const auto it = std::lower_bound(codes.begin(), codes.end(), value);
      return static_cast<std::uint32_t>(it - codes.begin());
    };
    return {first_at(code << 3 * level), first_at((code + 1) << 3 * level)};
  }
  const std::uint64_t wanted = key(code, level);
  for (std::size_t i = home(wanted);; i = (i + 1) & (slots_.size() - 1)) {
    if (slots_[i].key == wanted) return slots_[i].range;
    if (slots_[i].key == 0) return {};
  }
}

}  // namespace planescope
