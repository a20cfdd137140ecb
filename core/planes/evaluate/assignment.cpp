#include "core/planes/evaluate/assignment.hpp"

#include <algorithm>
#include <limits>

namespace planescope::planes {

std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns) {
  // Square problem of costs, padded with zeros; rows and columns counted from 1, as is usual.
  const int n = std::max(rows, columns);
  const auto cost = [&](int row, int column) {
    return row <= rows && column <= columns
               ? -value[static_cast<std::size_t>(row - 1) * columns + (column - 1)]
               : 0.0;
  };
  std::vector<double> row_potential(n + 1, 0), column_potential(n + 1, 0);
  std::vector<int> row_of(n + 1, 0), way(n + 1, 0);
  for (int row = 1; row <= n; ++row) {
    row_of[0] = row;
    int column = 0;
    std::vector<double> least(n + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> used(n + 1, false);
    do {
      used[column] = true;
      const int from = row_of[column];
      double delta = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int c = 1; c <= n; ++c) {
        if (used[c]) continue;
        const double reduced = cost(from, c) - row_potential[from] - column_potential[c];
        if (reduced < least[c]) {
          least[c] = reduced;
          way[c] = column;
        }
        if (least[c] < delta) {
          delta = least[c];
          next = c;
        }
      }
      for (int c = 0; c <= n; ++c) {
        if (used[c]) {
          row_potential[row_of[c]] += delta;
          column_potential[c] -= delta;
        } else {
          least[c] -= delta;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = way[column]) row_of[column] = row_of[way[column]];
  }
  std::vector<int> result(rows, -1);
  for (int c = 1; c <= columns; ++c)
    if (row_of[c] <= rows && cost(row_of[c], c) < 0) result[row_of[c] - 1] = c - 1;
  return result;
}

}  // namespace planescope::planes
