#pragma once

#include <vector>

namespace planescope::planes {

/// Hungarian method (Kuhn-Munkres with potentials, O(n^3)): the assignment of rows to columns with
/// the greatest total of `value` (row-major, rows x columns, values >= 0). Per row its column, -1
/// where the row got none or a pair of value 0.
std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns);

}  // namespace planescope::planes
