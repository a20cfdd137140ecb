#include "core/labels/fragments.hpp"

#include <algorithm>
#include <numeric>

namespace planescope {
namespace {

/// Union-find with path halving.
int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

std::vector<int> count_fragments(const Image16& image) {
  if (image.empty()) return {};
  std::vector<int> parent(image.pixels());
  std::iota(parent.begin(), parent.end(), 0);
  const auto join_if_same = [&](int a, int b) {
    if (image.data[a] != image.data[b]) return;
    const int root_a = root_of(parent, a), root_b = root_of(parent, b);
    parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int i = y * image.width + x;
      if (x > 0) join_if_same(i - 1, i);
      if (y > 0) join_if_same(i - image.width, i);
    }
  }
  std::vector<int> counts(*std::max_element(image.data.begin(), image.data.end()) + 1, 0);
  for (std::size_t i = 0; i < parent.size(); ++i)
    if (parent[i] == static_cast<int>(i)) ++counts[image.data[i]];
  return counts;
}

}  // namespace planescope
