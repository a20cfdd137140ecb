#pragma once

// Which region a joined one has become.

#include <cstdint>
#include <numeric>
#include <vector>

namespace planescope::planes {

class Roots {
 public:
  explicit Roots(std::size_t count) : into_(count) { std::iota(into_.begin(), into_.end(), 0); }
  std::int32_t root(std::int32_t k) {
    while (into_[k] != k) k = into_[k] = into_[into_[k]];
    return k;
  }
  void join_into(std::int32_t from, std::int32_t into) { into_[from] = into; }
  /// Replaces every region by its root; negative ones stay.
  void apply_to(std::vector<std::int32_t>& regions) {
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(into_.size()); ++k) into_[k] = root(k);
    for (std::int32_t& region : regions)
      if (region >= 0) region = into_[region];
  }

 private:
  std::vector<std::int32_t> into_;
};

}  // namespace planescope::planes
