#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/planes/classify/z_order.hpp"

namespace planescope::planes {

/// The eight cells that make up a cell of the level above, in Z-order.
struct Siblings {
  std::array<std::uint32_t, 9> begin{};  // points begin[i]..begin[i + 1] lie in cell i
  std::uint8_t occupied = 0;             // bit i: cell i holds points
};

/// Finds the points of cells: a hash table of all that are occupied, from some level upwards.
class CellTable {
 public:
  CellTable() = default;
  /// `codes`: ascending; `level`: of the finest cells in the table.
  CellTable(std::span<const std::uint64_t> codes, int level);

  /// The cells of `level` (below kZBits) in the cell of the level above that has this code, which
  /// is that of its points shifted right by 3 * (level + 1). Below the table's own level they are
  /// searched for in the codes it was made from: the same answer, but slower.
  Siblings find(std::span<const std::uint64_t> codes, std::uint64_t parent, int level) const;

 private:
  struct Slot {
    std::uint64_t key = 0;  // 0: free
    Siblings siblings;
  };
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15 >> shift_);
  }
  void insert(std::uint64_t key, const Siblings& siblings);

  int level_ = kZBits;
  int shift_ = 0;
  std::vector<Slot> slots_;
};

/// Points in Z-order and the way to those of any cell.
struct CellIndex {
  ZOrder z;
  std::vector<Vec3f> points;
  std::array<std::vector<float>, 3> axes;  // the same; longer, so that whole groups may be read
  std::size_t crowd = 0;                   // candidates that are too many: a smaller cell will do
  int level = 0;                           // where searches begin
  CellTable cells;                         // from there upwards
};

}  // namespace planescope::planes
