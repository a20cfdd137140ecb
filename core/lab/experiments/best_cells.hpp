#pragma once

#include <vector>

#include "core/lab/bench/table.hpp"

namespace planescope::lab {

/// By row and column, whether a method is best there: in its column, which says by its name whether
/// the least, the most or the nearest to 100 is good; or in its row, where methods are columns (a
/// table of mean IoU). Printed numbers, the oracle and true labels do not compete; of other tables
/// nothing is best.
std::vector<std::vector<bool>> best_cells(const Table& table);

}  // namespace planescope::lab
