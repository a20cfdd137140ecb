#include "core/planes/evaluate/plane_match.hpp"

#include <algorithm>

#include "core/planes/evaluate/assignment.hpp"

namespace planescope::planes {

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

}  // namespace planescope::planes
