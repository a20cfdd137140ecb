#include "core/labels/model/region.hpp"

namespace planescope::labels {

std::vector<std::uint32_t> flood(const std::vector<std::uint8_t>& passable,
                                 int width,
                                 int height,
                                 std::span<const std::uint32_t> start,
                                 std::vector<std::uint8_t>& region) {
  // Row by row: a run is filled whole, and the rows above and below are searched along it.
  std::vector<std::uint32_t> added;
  std::vector<std::uint32_t> open(start.begin(), start.end());
  const auto free = [&](std::size_t i) { return passable[i] && !region[i]; };
  while (!open.empty()) {
    const std::uint32_t pixel = open.back();
    open.pop_back();
    if (!free(pixel)) continue;
    const std::size_t row = pixel / width * static_cast<std::size_t>(width);
    std::size_t first = pixel, end = pixel + std::size_t{1};
    while (first > row && free(first - 1)) --first;
    while (end < row + width && free(end)) ++end;
    for (std::size_t i = first; i < end; ++i) {
      region[i] = 1;
      added.push_back(static_cast<std::uint32_t>(i));
    }
    const auto search = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
        if (free(i) && (i + 1 == to || !free(i + 1))) open.push_back(static_cast<std::uint32_t>(i));
    };
    if (row > 0) search(first - width, end - width);
    if (row + width < static_cast<std::size_t>(width) * height) search(first + width, end + width);
  }
  return added;
}

void spread(const std::vector<std::uint8_t>& passable,
            int width,
            int height,
            int reach,
            std::vector<std::uint8_t>& region) {
  std::vector<std::uint32_t> front, next;
  const auto visit = [&](std::uint32_t i) {
    if (!passable[i] || region[i]) return;
    region[i] = 1;
    next.push_back(i);
  };
  const auto visit_around = [&](std::uint32_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    if (x > 0) visit(i - 1);
    if (x + 1 < width) visit(i + 1);
    if (y > 0) visit(i - width);
    if (y + 1 < height) visit(i + width);
  };
  // The first ring in one pass: most of a region has no open neighbour.
  for (std::size_t i = 0; i < region.size(); ++i)
    if (region[i]) front.push_back(static_cast<std::uint32_t>(i));
  for (int step = 0; step < reach && !front.empty(); ++step) {
    for (const std::uint32_t i : front) visit_around(i);
    front.swap(next);
    next.clear();
  }
}

std::vector<std::uint32_t> small_holes(const std::vector<std::uint8_t>& region,
                                       int width,
                                       int height,
                                       int most) {
  std::vector<std::uint32_t> holes, hole;
  enum : std::uint8_t { kOpen, kRegion, kThisHole, kNoHole };
  std::vector<std::uint8_t> seen = region;
  for (std::size_t first = 1; first < region.size(); ++first) {
    if (seen[first] || !region[first - 1]) continue;  // a hole begins right of the region
    hole.assign(1, static_cast<std::uint32_t>(first));
    seen[first] = kThisHole;
    bool closed = true;
    for (std::size_t k = 0; k < hole.size() && closed; ++k) {
      const std::uint32_t i = hole[k];
      const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
      if (x == 0 || y == 0 || x + 1 == width || y + 1 == height) {
        closed = false;
        break;
      }
      for (const std::uint32_t j : {i - 1, i + 1, i - width, i + width}) {
        if (seen[j] == kNoHole) closed = false;
        if (seen[j] != kOpen) continue;
        seen[j] = kThisHole;
        hole.push_back(j);
      }
      closed = closed && hole.size() <= static_cast<std::size_t>(most);
    }
    // What was too large is left half visited; whatever touches it is no hole either.
    for (const std::uint32_t i : hole) seen[i] = closed ? kRegion : kNoHole;
    if (closed) holes.insert(holes.end(), hole.begin(), hole.end());
  }
  return holes;
}

}  // namespace planescope::labels
