#include "core/labels/model/fragments.hpp"

#include <algorithm>

#include "core/model/disjoint_sets.hpp"

namespace planescope::labels {

std::vector<int> count_fragments(const Image16& image) {
  if (image.empty()) return {};
  DisjointSets sets(image.pixels());
  const auto join_if_same = [&](int a, int b) {
    if (image.data[a] == image.data[b])
      sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int i = y * image.width + x;
      if (x > 0) join_if_same(i - 1, i);
      if (y > 0) join_if_same(i - image.width, i);
    }
  }
  std::vector<int> counts(*std::max_element(image.data.begin(), image.data.end()) + 1, 0);
  for (std::uint32_t i = 0; i < sets.size(); ++i)
    if (sets.root(i) == i) ++counts[image.data[i]];
  return counts;
}

}  // namespace planescope::labels
