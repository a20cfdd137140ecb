#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/classify/z_order.hpp"

namespace planescope {

/// Finds the points of a cell: a hash table of the occupied cells from some level upwards.
class CellTable {
 public:
  struct Range {
    std::uint32_t begin = 0, end = 0;  // in Z-order
  };

  CellTable() = default;
  /// `codes`: ascending; must outlive the table's use below `level`, see find().
  CellTable(std::span<const std::uint64_t> codes, int level);

  /// The points of the cell with this code (those of level 0 shifted right by 3 * level). Levels
  /// below that of the table are looked up in `codes` itself: the same answer, but slower.
  Range find(std::span<const std::uint64_t> codes, std::uint64_t code, int level) const;

 private:
  struct Slot {
    std::uint64_t key = 0;  // 0: free
    Range range;
  };
  /// Unique among all levels: the code behind a leading one.
  static std::uint64_t key(std::uint64_t code, int level) {
    return code | std::uint64_t{1} << 3 * (kZBits - level);
  }
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15 >> shift_);
  }
  void insert(std::uint64_t key, Range range);

  int level_ = kZBits + 1;
  int shift_ = 0;
  std::vector<Slot> slots_;
};

}  // namespace planescope
