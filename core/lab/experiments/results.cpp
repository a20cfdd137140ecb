#include "core/lab/experiments/results.hpp"

#include <algorithm>

namespace planescope::lab {

const Cell* PaperResults::find(const CellKey& key) const {
  const auto found = std::ranges::find(cells, key, &Cell::key);
  return found != cells.end() ? &*found : nullptr;
}

}  // namespace planescope::lab
