// Traces the borders of connected regions of a label image.

#include "core/planes/outline/rings.hpp"

#include <algorithm>

#include "core/model/disjoint_sets.hpp"

namespace planescope::planes {
namespace {

/// Runs of each label per row, with the connected region of each run.
class Regions {
 public:
  struct Run {
    int begin = 0, end = 0;
    std::int32_t label = 0;
    std::int32_t part = -1;
  };

  Regions(std::span<const std::int32_t> labels, int width, int height) : first_{0} {
    for (int y = 0; y < height; ++y) {
      const auto row = labels.subspan(static_cast<std::size_t>(y) * width, width);
      for (std::size_t begin = 0, end = 0; begin < row.size(); begin = end) {
        end = end_of_run(row, begin);
        if (row[begin] > 0)
          runs_.push_back({static_cast<int>(begin), static_cast<int>(end), row[begin]});
      }
      first_.push_back(static_cast<std::uint32_t>(runs_.size()));
    }
    DisjointSets sets(runs_.size());
    for (int y = 1; y < height; ++y) {
      std::uint32_t above = first_[y - 1];
      for (std::uint32_t r = first_[y]; r < first_[y + 1]; ++r) {
        while (above < first_[y] && runs_[above].end <= runs_[r].begin) ++above;
        for (std::uint32_t a = above; a < first_[y] && runs_[a].begin < runs_[r].end; ++a)
          if (runs_[a].label == runs_[r].label) sets.join(a, r);
      }
    }
    // Numbered in raster order of their first pixel.
    std::vector<std::int32_t> part_of(runs_.size(), -1);
    std::int32_t parts = 0;
    for (std::uint32_t r = 0; r < runs_.size(); ++r) {
      std::int32_t& of_root = part_of[sets.root(r)];
      if (of_root < 0) of_root = parts++;
      runs_[r].part = of_root;
    }
  }

  std::span<const Run> row(int y) const {
    return std::span(runs_).subspan(first_[y], first_[y + 1] - first_[y]);
  }

 private:
  std::vector<Run> runs_;
  std::vector<std::uint32_t> first_;  // index of each row's first run
};

/// Ordered by left turns.
enum Heading { kDown, kRight, kUp, kLeft };

/// Twice the signed area; positive if the interior is on the left.
std::int64_t twice_area(const std::vector<Corner>& corners) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += static_cast<std::int64_t>(b.x) * a.y - static_cast<std::int64_t>(a.x) * b.y;
  }
  return sum;
}

}  // namespace

std::vector<Ring> trace_rings(std::span<const std::int32_t> labels, int width, int height) {
  const auto label_at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= width || y >= height
               ? 0
               : labels[static_cast<std::size_t>(y) * width + x];
  };
  const Regions regions(labels, width, height);
  std::vector<std::uint8_t> gone_down(labels.size(), 0);  // per pixel: its left edge has
                                                          // been visited
  std::vector<Ring> rings;

  const auto follow = [&](Ring& ring, const Corner& start) {
    // Pixels ahead of a corner, on the left and on the right.
    constexpr Corner kAheadLeft[] = {{0, 0}, {0, -1}, {-1, -1}, {-1, 0}};
    constexpr Corner kAheadRight[] = {{-1, 0}, {0, 0}, {0, -1}, {-1, -1}};
    constexpr Corner kStep[] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    constexpr Corner kBehindLeft[] = {{1, -1}, {-1, -1}, {-1, 1}, {1, 1}};
    Corner at = start;
    int heading = kDown;
    do {
      if (heading == kDown) gone_down[static_cast<std::size_t>(at.y) * width + at.x] = 1;
      at.x += kStep[heading].x, at.y += kStep[heading].y;
      const auto has = [&](const Corner& pixel) {
        return label_at(at.x + pixel.x, at.y + pixel.y) == ring.label;
      };
      const bool left = has(kAheadLeft[heading]), right = has(kAheadRight[heading]);
      if (left && !right) continue;
      const Corner own = right && !left ? kBehindLeft[heading] : Corner{};
      ring.corners.push_back({at.x, at.y, own.x, own.y});
      heading = (heading + (left ? 3 : 1)) % 4;
    } while (at.x != start.x || at.y != start.y || heading != kDown);
  };

  for (int y = 0; y < height; ++y)
    for (const Regions::Run& run : regions.row(y)) {
      if (gone_down[static_cast<std::size_t>(y) * width + run.begin]) continue;
      Ring& ring = rings.emplace_back();
      ring.label = run.label;
      ring.part = run.part;
      follow(ring, {run.begin, y});
      ring.hole = twice_area(ring.corners) < 0;
    }
  return rings;
}

std::vector<PixelRun> pixels_inside(const Ring& ring) {
  struct Crossing {
    int y = 0, x = 0;
    auto operator<=>(const Crossing&) const = default;
  };
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < ring.corners.size(); ++i) {
    const Corner &a = ring.corners[i], &b = ring.corners[(i + 1) % ring.corners.size()];
    for (int y = std::min(a.y, b.y); y < std::max(a.y, b.y); ++y) crossings.push_back({y, a.x});
  }
  std::ranges::sort(crossings);
  std::vector<PixelRun> runs;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    runs.push_back({crossings[i].y, crossings[i].x, crossings[i + 1].x});
  return runs;
}

}  // namespace planescope::planes
