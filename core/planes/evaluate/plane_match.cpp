#include "core/planes/evaluate/plane_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

double TruthOverlap::iou(int t, int f) const {
  const std::uint64_t both = at(t, f), all = truth_size[t] + found_size[f] - both;
  return all > 0 ? static_cast<double>(both) / static_cast<double>(all) : 0;
}

TruthOverlap count_truth_overlap(std::span<const std::int32_t> truth,
                                 std::span<const std::int32_t> found,
                                 int last_truth,
                                 int last_found) {
  TruthOverlap o;
  o.truth = last_truth;
  o.found = last_found;
  for (const std::int32_t t : truth) o.truth = std::max(o.truth, t);
  for (const std::int32_t f : found) o.found = std::max(o.found, f);
  o.shared.assign(static_cast<std::size_t>(o.truth + 1) * (o.found + 1), 0);
  o.truth_size.assign(o.truth + 1, 0);
  o.found_size.assign(o.found + 1, 0);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] < 0) continue;
    const int t = truth[i], f = std::max(0, found[i]);
    ++o.shared[static_cast<std::size_t>(t) * (o.found + 1) + f];
    ++o.truth_size[t];
    ++o.found_size[f];
  }
  return o;
}

std::vector<int> found_of_truth(const TruthOverlap& o) {
  std::vector<double> iou;
  for (int t = 1; t <= o.truth; ++t)
    for (int f = 1; f <= o.found; ++f) iou.push_back(o.iou(t, f));
  std::vector<int> match = best_assignment(iou, o.truth, o.found);
  for (int& column : match) ++column;
  return match;
}

double plane_angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 180 / std::numbers::pi;
}

}  // namespace planescope::planes
