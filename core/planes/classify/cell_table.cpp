#include "core/planes/classify/cell_table.hpp"

#include <algorithm>
#include <bit>

namespace planescope::planes {
namespace {

/// Unique among all levels: the code behind a leading one.
std::uint64_t make_key(std::uint64_t parent, int level) {
  return parent | std::uint64_t{1} << 3 * (kZBits - 1 - level);
}

/// The highest level at which a cell begins with point i; -1 for none.
int highest_begun(std::span<const std::uint64_t> codes, std::size_t i) {
  if (i == 0) return kZBits;
  const std::uint64_t differs = codes[i] ^ codes[i - 1];
  return differs != 0 ? (63 - std::countl_zero(differs)) / 3 : -1;
}

Siblings search(std::span<const std::uint64_t> codes, std::uint64_t parent, int level) {
  Siblings found;
  for (std::uint64_t i = 0; i <= 8; ++i) {
    const auto at = std::lower_bound(codes.begin() + found.begin[i > 0 ? i - 1 : 0], codes.end(),
                                     (parent * 8 + i) << 3 * level);
    found.begin[i] = static_cast<std::uint32_t>(at - codes.begin());
    if (i > 0 && found.begin[i] > found.begin[i - 1])
      found.occupied = static_cast<std::uint8_t>(found.occupied | 1 << (i - 1));
  }
  return found;
}

}  // namespace

CellTable::CellTable(std::span<const std::uint64_t> codes, int level) : level_(level) {
  std::size_t parents = 0;
  for (std::size_t i = 0; i < codes.size(); ++i)
    parents += static_cast<std::size_t>(std::max(0, highest_begun(codes, i) - level));
  const std::size_t capacity = std::bit_ceil(2 * parents + 2);
  shift_ = 64 - std::countr_zero(capacity);
  slots_.resize(capacity);

  struct Open {
    Siblings siblings;
    std::uint32_t known = 0;  // how many of siblings.begin
    void know(std::uint32_t up_to, std::size_t point) {
      while (known <= up_to) siblings.begin[known++] = static_cast<std::uint32_t>(point);
    }
  };
  std::array<Open, kZBits> open;  // by level of the siblings
  for (std::size_t i = 0; i <= codes.size() && !codes.empty(); ++i) {
    const bool end = i == codes.size();
    const int begun = end ? kZBits : highest_begun(codes, i);
    for (int l = level; l < kZBits && l <= begun; ++l) {
      if (i > 0 && begun > l) {  // their parent ends here
        open[l].know(8, i);
        insert(make_key(codes[i - 1] >> 3 * (l + 1), l), open[l].siblings);
        open[l] = {};
      }
      if (end) continue;
      const auto child = static_cast<std::uint32_t>(codes[i] >> 3 * l & 7);
      open[l].know(child, i);
      open[l].siblings.occupied = static_cast<std::uint8_t>(open[l].siblings.occupied | 1 << child);
    }
  }
}

void CellTable::insert(std::uint64_t key, const Siblings& siblings) {
  std::size_t i = home(key);
  while (slots_[i].key != 0) i = (i + 1) & (slots_.size() - 1);
  slots_[i] = {key, siblings};
}

Siblings CellTable::find(std::span<const std::uint64_t> codes,
                         std::uint64_t parent,
                         int level) const {
  if (level < level_) return search(codes, parent, level);
  const std::uint64_t key = make_key(parent, level);
  for (std::size_t i = home(key);; i = (i + 1) & (slots_.size() - 1)) {
    if (slots_[i].key == key) return slots_[i].siblings;
    if (slots_[i].key == 0) return {};
  }
}

}  // namespace planescope::planes
